#include "colmap_seapoint/pipeline/completeness_models.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"
#include "colmap_seapoint/pipeline/completeness/completeness_reporter.h"
#include "colmap_seapoint/pipeline/completeness/write_gap_files.h"
#include "colmap_seapoint/pipeline/page/completeness_page.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
constexpr char kPrefix[] = "completeness_", kFormerPrefix[] = "completeness_before_";
constexpr char kFactsPrefix[] = "picture_facts_";  // of files beside the stages' records

struct Assessment {
  std::string answer;
  RunReport run;
};

void to_json(nlohmann::ordered_json& json, const Assessment& assessment) {
  json = {{"answer", assessment.answer}, {"run", assessment.run}};
}

void from_json(const nlohmann::ordered_json& json, Assessment& assessment) {
  assessment = {json.at("answer").get<std::string>(), json.at("run").get<RunReport>()};
}

CompletenessReporterOptions ReporterOptions(const AutomaticReconstructorOptions& options,
                                            const Workspace& workspace,
                                            const std::vector<ModelSummary>& models,
                                            const ModelSummary& model) {
  CompletenessReporterOptions reporter;
  reporter.image_path = workspace.images.string();
  reporter.input_path = model.path.string();
  reporter.cloud_path = model.cloud_path.string();
  reporter.output_path = (workspace.report / "completeness" / model.name).string();
  reporter.mask_path = options.reader.mask_path;
  reporter.map_path = model.map_path.string();
  reporter.completeness = options.completeness;
  if (reporter.completeness.step == 0) reporter.completeness.step = options.densification.step;
  for (const ModelSummary& other : models) {
    if (other.name == model.name) continue;
    std::copy_if(other.pictures.begin(), other.pictures.end(),
                 std::back_inserter(reporter.posed_elsewhere), [&](const std::string& name) {
                   return std::find(model.pictures.begin(), model.pictures.end(), name) ==
                          model.pictures.end();
                 });
  }
  reporter.run = options.run;
  return reporter;
}

// The cloud tells of most; the pictures also of those that are in no model.
std::string InputsOf(const CompletenessReporterOptions& reporter, const ModelSummary& model,
                     const std::string& mapper_fingerprint, const std::string& map,
                     const RunReport& report) {
  std::string text = mapper_fingerprint + model.name + "," + model.scaling_fingerprint +
                     model.cloud_hash +
                     PictureMasks(reporter.mask_path).Fingerprint(model.pictures) +
                     OptionsFingerprint(OptionValues(reporter.completeness)) + kPageVersion + map;
  for (const RunReport::Input& input : report.inputs) text += "\n" + input.name + " " + input.hash;
  return text;
}

// The report before the one of this cloud, kept until pictures come in: a run that is interrupted
// while it writes, or that makes the report again, compares with the same one.
struct FormerRecord {
  std::string cloud;   // of the report that is compared with it
  std::string report;  // FormerReportText
};

void to_json(nlohmann::ordered_json& json, const FormerRecord& record) {
  json = {{"cloud", record.cloud}, {"report", record.report}};
}

void from_json(const nlohmann::ordered_json& json, FormerRecord& record) {
  record = {json.at("cloud").get<std::string>(), json.at("report").get<std::string>()};
}

// Of the model of that number.
FormerReport FormerReportOf(const CompletenessReporterOptions& reporter, const std::string& number,
                            const std::string& cloud, WorkspaceState* state) {
  const Stage stage = {kFormerPrefix + number, "1", "", ""};
  FormerRecord record = ResultIfDone<FormerRecord>(*state, stage).value_or(FormerRecord());
  if (record.cloud != cloud || record.report.empty()) {
    // What an interrupted run has left there is no report.
    if (record.report.empty() || state->Read(kPrefix + number)) {
      record.report =
          FormerReportText(ReadFormerReport(fs::path(reporter.output_path) / kCompletenessFile));
    }
    record.cloud = cloud;
    FinishStage(stage, record, {}, state);
  }
  return ParseFormerReport(record.report, (state->StateFolder() / stage.name).string());
}

std::string AnswerOf(CompletenessReporterOptions reporter, const Stage& stage,
                     const std::string& number, const std::string& cloud, WorkspaceState* state,
                     RunReport* report) {
  try {
    reporter.former = FormerReportOf(reporter, number, cloud, state);
    Assessment done = RunStage<Assessment>(state, stage, [&]() -> StageOutput<Assessment> {
      CompletenessReport made = ReportCompleteness(reporter);
      return {{made.answer, made.run}, FilesOfOurs(reporter.output_path)};
    });
    // What could not be read is named by the stages before.
    if (!done.run.left_out.empty()) state->Forget(stage.name);
    for (RunReport::Stage& part : done.run.stages) {
      part.name += " " + number;
      report->stages.push_back(std::move(part));
    }
    return done.answer;
  } catch (const Error& e) {
    LeaveOut("completeness of sparse/" + number, e.what(), report);
    return "";
  }
}

fs::path FactsFile(const std::string& number, const WorkspaceState& state) {
  return state.StateFolder() / (kFactsPrefix + number);
}

// Those of the models from that number on.
void RemoveStaleFacts(size_t first, const WorkspaceState& state) {
  std::error_code ignored;
  for (size_t k = first; fs::remove(FactsFile(std::to_string(k), state), ignored); ++k) {
  }
}

}  // namespace

void ReportCompletenessOfModels(const AutomaticReconstructorOptions& options,
                                const Workspace& workspace, const std::string& mapper_fingerprint,
                                WorkspaceState* state, std::vector<ModelSummary>* models,
                                RunReport* report) {
  const fs::path folder = workspace.report / "completeness";
  const size_t num_reports = options.report_completeness ? models->size() : 0;
  for (const char* prefix : {kPrefix, kFormerPrefix}) {
    RemoveStaleStages(prefix, num_reports, folder, state);
  }
  RemoveStaleFacts(num_reports, *state);
  if (!options.report_completeness) return;
  // Of the page's map: what it is made of beyond what is named anyway.
  const std::string map = kOrthomosaicVersion + OptionsFingerprint(OptionValues(options.map));
  for (ModelSummary& model : *models) {
    if (model.densification.points == 0) continue;
    CompletenessReporterOptions reporter = ReporterOptions(options, workspace, *models, model);
    reporter.facts_file = FactsFile(model.name, *state).string();
    const Stage stage = {
        kPrefix + model.name, kCompletenessVersion,
        InputsOf(reporter, model, mapper_fingerprint, model.map_path.empty() ? "" : map, *report),
        "The report in " + reporter.output_path + " is there already"};
    const std::string cloud = HashText(mapper_fingerprint + model.name + "," +
                                       model.scaling_fingerprint + "," + model.cloud_hash);
    model.completeness = AnswerOf(reporter, stage, model.name, cloud, state, report);
  }
}

}  // namespace colmap_seapoint
