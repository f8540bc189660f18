#include "colmap_seapoint/pipeline/page/job_page.h"

#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/page/html_page.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Empty where the model has no page.
std::string SectionOf(const fs::path& page) {
  const auto in = OpenIfThere(page);
  if (in == nullptr) return "";
  const auto sections = SectionsOfPage(std::string{std::istreambuf_iterator<char>(*in), {}});
  return sections.empty() ? "" : sections.front();
}

std::string AnswerOf(const std::vector<ModelSummary>& models, const RunReport& report) {
  std::string answer;
  for (const ModelSummary& model : models) {
    if (model.completeness.empty()) continue;
    if (!answer.empty()) answer += " ";
    if (models.size() > 1) answer += "Model " + model.name + ": ";
    answer += model.completeness + ".";
  }
  if (!answer.empty()) return answer;
  return std::to_string(report.images_used) + " of " + std::to_string(report.images_in) +
         " pictures were used; what is covered was not looked at.";
}

}  // namespace

void WriteJobPage(const Workspace& workspace, const std::vector<ModelSummary>& models,
                  const RunReport& report) {
  PageContent page;
  page.title = "Did we cover it all? " + workspace.root.filename().string();
  page.answer = AnswerOf(models, report);
  for (const ModelSummary& model : models) {
    if (model.completeness.empty()) continue;
    std::string section = SectionOf(workspace.report / "completeness" / model.name / "index.html");
    if (section.empty()) continue;
    page.sections.push_back(std::move(section));
    page.names.push_back(model.name);
  }
  RunReport job = report;
  job.inputs.clear();
  const nlohmann::ordered_json json = job;
  page.job = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  WriteTextFile(workspace.report / "index.html", HtmlPage(std::move(page)));
}

}  // namespace colmap_seapoint
