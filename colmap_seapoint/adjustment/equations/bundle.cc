#include "colmap_seapoint/adjustment/equations/bundle.h"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace colmap_seapoint {
namespace {

// A feature that takes part, before its place in the tables is known.
struct Candidate {
  uint32_t point, image, feature;
};

std::vector<uint64_t> IdsOf(const SparseModel& model) {
  std::vector<uint64_t> ids;
  ids.reserve(model.points3D.size());
  for (const auto& [id, point] : model.points3D) ids.push_back(id);
  return ids;
}

// In the order of the pictures. `ids` ascend.
std::vector<Candidate> FindCandidates(const SparseModel& model, const std::vector<uint64_t>& ids) {
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const PosedImage& image = model.images[i];
    const auto camera = model.cameras.find(image.camera_id);
    if (camera == model.cameras.end()) continue;
    if (camera->second.model == CameraModel::kEquirectangular) continue;
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      const auto id = std::lower_bound(ids.begin(), ids.end(), image.point3D_ids[k]);
      if (id == ids.end() || *id != image.point3D_ids[k]) continue;
      const Eigen::Vector3d in_cam = image.cam_from_world * model.points3D.at(*id).xyz;
      if (!camera->second.ImgFromCam(in_cam) || !image.points2D[k].allFinite()) continue;
      candidates.push_back({static_cast<uint32_t>(id - ids.begin()), static_cast<uint32_t>(i),
                            static_cast<uint32_t>(k)});
    }
  }
  return candidates;
}

// By point, and within a point in the order of the pictures; without those of points that fewer
// than two pictures see.
std::vector<Candidate> SortByPoint(std::vector<Candidate> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.point < b.point; });
  std::vector<Candidate> kept;
  kept.reserve(candidates.size());
  for (auto first = candidates.begin(); first != candidates.end();) {
    const auto last = std::find_if(first, candidates.end(),
                                   [&](const Candidate& c) { return c.point != first->point; });
    if (first->image != std::prev(last)->image) kept.insert(kept.end(), first, last);
    first = last;
  }
  return kept;
}

BundleLens LensOf(const Camera& camera, const LensFreedom& freedom) {
  BundleLens lens;
  lens.model = camera.model;
  lens.slots.fill(-1);
  const auto num_focals = static_cast<size_t>(NumFocals(camera.model));
  for (size_t k = 0; k < camera.params.size(); ++k) {
    const bool is_tied = k == 1 && num_focals == 2 && freedom.ties_focals;
    if (is_tied) {
      lens.slots[1] = lens.slots[0];
    } else if (!freedom.Holds(k)) {
      lens.slots[k] = lens.num_free++;
    }
  }
  const auto add_prior = [&](size_t param, double value, double sigma) {
    if (lens.slots[param] < 0 || !(sigma > 0)) return;
    lens.prior[param] = value;
    lens.prior_weights[param] = 1 / (sigma * sigma);
  };
  add_prior(num_focals, camera.PrincipalX(), freedom.principal_point_sigma);
  add_prior(num_focals + 1, camera.PrincipalY(), freedom.principal_point_sigma);
  add_prior(0, freedom.focal_prior, freedom.focal_sigma);
  if (num_focals == 2 && !freedom.ties_focals) {
    add_prior(1, freedom.focal_prior, freedom.focal_sigma);
  }
  return lens;
}

LensFreedom FreedomOf(const std::map<uint32_t, LensFreedom>& freedom, uint32_t camera_id) {
  const auto found = freedom.find(camera_id);
  return found == freedom.end() ? LensFreedom() : found->second;
}

// Gives the pictures and lenses that the observations need their numbers, in the order of the
// model.
void AddPictures(const SparseModel& model, const std::map<uint32_t, LensFreedom>& freedom,
                 const std::vector<Candidate>& observations, Bundle* bundle) {
  std::vector<bool> is_used(model.images.size());
  for (const Candidate& c : observations) is_used[c.image] = true;
  std::map<uint32_t, uint32_t> lens_of_camera;
  for (uint32_t i = 0; i < model.images.size(); ++i) {
    if (!is_used[i]) continue;
    const uint32_t camera_id = model.images[i].camera_id;
    const auto [lens, is_new] =
        lens_of_camera.emplace(camera_id, static_cast<uint32_t>(lens_of_camera.size()));
    if (is_new) {
      bundle->lenses.push_back(LensOf(model.cameras.at(camera_id), FreedomOf(freedom, camera_id)));
      bundle->camera_id.push_back(camera_id);
    }
    bundle->lens_of_picture.push_back(lens->second);
    bundle->image_idx.push_back(i);
  }
}

void AddObservations(const SparseModel& model, const std::vector<uint64_t>& ids,
                     const std::vector<Candidate>& observations, Bundle* bundle) {
  std::vector<uint32_t> picture_of_image(model.images.size());
  for (uint32_t i = 0; i < bundle->NumPictures(); ++i) picture_of_image[bundle->image_idx[i]] = i;
  bundle->pixels.reserve(observations.size());
  bundle->picture_of.reserve(observations.size());
  bundle->point_of.reserve(observations.size());
  for (const Candidate& c : observations) {
    if (bundle->point_id.empty() || bundle->point_id.back() != ids[c.point]) {
      bundle->point_id.push_back(ids[c.point]);
      bundle->point_begin.push_back(static_cast<uint32_t>(bundle->pixels.size()));
    }
    bundle->pixels.push_back(model.images[c.image].points2D[c.feature]);
    bundle->picture_of.push_back(picture_of_image[c.image]);
    bundle->point_of.push_back(static_cast<uint32_t>(bundle->point_id.size() - 1));
  }
  bundle->point_begin.push_back(static_cast<uint32_t>(bundle->pixels.size()));
}

void IndexByPicture(Bundle* bundle) {
  bundle->picture_begin.assign(bundle->NumPictures() + 1, 0);
  for (uint32_t picture : bundle->picture_of) ++bundle->picture_begin[picture + 1];
  std::partial_sum(bundle->picture_begin.begin(), bundle->picture_begin.end(),
                   bundle->picture_begin.begin());
  std::vector<uint32_t> next = bundle->picture_begin;
  bundle->of_picture.resize(bundle->NumObservations());
  for (uint32_t k = 0; k < bundle->NumObservations(); ++k) {
    bundle->of_picture[next[bundle->picture_of[k]]++] = k;
  }
}

void ListShares(Bundle* bundle) {
  std::vector<uint32_t> lenses;
  for (size_t p = 0; p < bundle->NumPoints(); ++p) {
    bundle->share_begin.push_back(static_cast<uint32_t>(bundle->share_lens.size()));
    lenses.clear();
    for (uint32_t k = bundle->point_begin[p]; k < bundle->point_begin[p + 1]; ++k) {
      lenses.push_back(bundle->lens_of_picture[bundle->picture_of[k]]);
    }
    std::sort(lenses.begin(), lenses.end());
    std::unique_copy(lenses.begin(), lenses.end(), std::back_inserter(bundle->share_lens));
  }
  bundle->share_begin.push_back(static_cast<uint32_t>(bundle->share_lens.size()));
}

}  // namespace

std::map<uint32_t, LensFreedom> AllLensesHeld(const SparseModel& model) {
  std::map<uint32_t, LensFreedom> lenses;
  for (const auto& [id, camera] : model.cameras) lenses[id].held_params = ~0u;
  return lenses;
}

Bundle MakeBundle(const SparseModel& model, const std::map<uint32_t, LensFreedom>& freedom,
                  const std::set<uint32_t>& held_images) {
  const std::vector<uint64_t> ids = IdsOf(model);
  const std::vector<Candidate> observations = SortByPoint(FindCandidates(model, ids));
  Bundle bundle;
  AddPictures(model, freedom, observations, &bundle);
  for (const uint32_t idx : bundle.image_idx) {
    bundle.holds_pose.push_back(held_images.count(model.images[idx].image_id) > 0);
  }
  AddObservations(model, ids, observations, &bundle);
  IndexByPicture(&bundle);
  ListShares(&bundle);
  return bundle;
}

BundleValues ReadValues(const Bundle& bundle, const std::map<uint32_t, LensFreedom>& freedom,
                        const SparseModel& model) {
  BundleValues values;
  for (uint32_t idx : bundle.image_idx) {
    const Rigid3d& pose = model.images[idx].cam_from_world;
    values.poses.push_back({pose.rotation.normalized().toRotationMatrix(), pose.translation});
  }
  for (uint32_t id : bundle.camera_id) {
    const Camera& camera = model.cameras.at(id);
    LensParams params{};
    std::copy(camera.params.begin(), camera.params.end(), params.begin());
    if (FreedomOf(freedom, id).ties_focals && NumFocals(camera.model) == 2) {
      params[0] = params[1] = camera.MeanFocal();
    }
    values.lenses.push_back(params);
  }
  values.points.reserve(bundle.NumPoints());
  for (uint64_t id : bundle.point_id) values.points.push_back(model.points3D.at(id).xyz);
  return values;
}

void WriteValues(const Bundle& bundle, const BundleValues& values, SparseModel* model) {
  for (size_t i = 0; i < bundle.NumPictures(); ++i) {
    if (bundle.holds_pose[i]) continue;
    Rigid3d& pose = model->images[bundle.image_idx[i]].cam_from_world;
    pose.rotation = Eigen::Quaterniond(values.poses[i].rotation).normalized();
    pose.translation = values.poses[i].translation;
  }
  for (size_t c = 0; c < bundle.lenses.size(); ++c) {
    std::vector<double>& params = model->cameras.at(bundle.camera_id[c]).params;
    std::copy_n(values.lenses[c].begin(), params.size(), params.begin());
  }
  for (size_t p = 0; p < bundle.NumPoints(); ++p) {
    model->points3D.at(bundle.point_id[p]).xyz = values.points[p];
  }
}

}  // namespace colmap_seapoint
