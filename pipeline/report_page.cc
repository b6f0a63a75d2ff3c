#include "pipeline/report_page.h"

#include <algorithm>
#include <string_view>

#include "pipeline/advice.h"
#include "pipeline/page_parts.h"
#include "pipeline/report.h"

namespace glint {

extern const std::string_view kReportTemplate;  // made of report_assets/report_template.html when Glint is built

namespace {

constexpr std::string_view kPlace = "<!--GLINT-DATA-->";

// JSON that cannot end its script element, open a comment in it, or break a line of JavaScript, whatever it says.
std::string ForHtml(const Json& json) {
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);  // ASCII only
  std::string safe;
  safe.reserve(text.size());
  for (char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else if (c == '>') {
      safe += "\\u003e";
    } else if (c == '&') {
      safe += "\\u0026";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string DataElement(const std::string& id, const Json& json) {
  return "<script type=\"application/json\" id=\"" + id + "\">" + ForHtml(json) + "</script>\n";
}

// The folder that a person calls the project: without COLMAP's own names below it, and names that say nothing.
std::string ProjectName(const std::filesystem::path& model) {
  for (std::filesystem::path path = std::filesystem::absolute(model).lexically_normal(); path.has_relative_path();
       path = path.parent_path()) {
    std::string name = path.filename().string();
    const bool digits = name.find_first_not_of("0123456789") == std::string::npos;
    const auto says_nothing = {"sparse", "dense", "colmap", "project"};
    if (!name.empty() && !digits && std::ranges::find(says_nothing, name) == says_nothing.end()) return name;
  }
  return "project";
}

std::string_view LevelName(AdviceLevel level) {
  switch (level) {
    case AdviceLevel::kProblem:
      return "problem";
    case AdviceLevel::kWarning:
      return "warning";
    case AdviceLevel::kNote:
      return "note";
    case AdviceLevel::kGood:
      return "good";
  }
  return "note";
}

Json AdviceJson(const PageInput& input) {
  const RefineResult& refined = input.refined;
  Json json = Json::array();
  for (const Advice& advice : GiveAdvice(input.summary, input.scene, refined.contacts, refined.lights, refined.mesh))
    json.push_back({{"level", LevelName(advice.level)}, {"finding", advice.finding}, {"cure", advice.cure}});
  return json;
}

Json Statuses() {
  Json json = Json::object();
  for (int s = 0; s < kNumHighlightStatuses; ++s) {
    const auto status = static_cast<HighlightStatus>(s);
    json[std::string(StatusName(status))] = StatusReason(status);
  }
  return json;
}

// What differs from run to run: taken out of report.json's content.
Json TakeRun(Json& report) {
  Json run;
  for (const char* key : {"command", "command_folder", "total_seconds", "stages"}) {
    run[key] = report[key];
    report.erase(key);
  }
  run["iteration_seconds"] = Json::array();
  for (Json& iteration : report["refine"]["iterations"]) {
    run["iteration_seconds"].push_back(iteration["seconds"]);
    iteration.erase("seconds");
  }
  return run;
}

PageFrame FrameOf(const PageInput& input) {
  Eigen::AlignedBox3d box = BoundingBox(input.refined.mesh.empty() ? input.seed : input.refined.mesh);
  if (input.refined.mesh.empty() && input.seed.empty())
    for (const ScenePoint& point : input.scene.points) box.extend(point.position);
  PageFrame frame;
  if (box.isEmpty() || !(box.diagonal().norm() > 0)) return frame;
  return {box.center(), box.diagonal().norm()};
}

}  // namespace

std::string ReportPage(const PageInput& input, Progress& progress, const PageOptions& options) {
  const PageFrame frame = FrameOf(input);
  const TriangleMesh& mesh = input.refined.mesh;
  Json data = {{"project", ProjectName(input.summary.model)}};
  data["report"] = Json::parse(ReportJson(input.summary));
  const Json run = TakeRun(data["report"]);
  data["advice"] = AdviceJson(input);
  data["config"] = ConfigYaml(input.config, "The options of this run, as resolved.");
  data["statuses"] = Statuses();
  data["frame"] = {{"center", {frame.center.x(), frame.center.y(), frame.center.z()}}, {"diagonal", frame.diagonal}};
  data["scene"] = PageViews(input.scene, input.refined.highlights, frame);
  data["contacts"] = PageContacts(input.refined.contacts, input.refined.lights, frame);
  data["lights"] = PageLights(input.summary.lights, input.scene, frame);
  data["after"] = PageMesh(mesh, input.seed, frame, options.max_faces);
  data["before"] = PageMesh(input.seed, mesh, frame, options.max_faces);
  data["photos"] = PagePhotos(input.scene, input.images, input.refined.highlights, options.max_photos,
                              options.photo_side_px, progress);

  const size_t place = kReportTemplate.find(kPlace);
  std::string page(kReportTemplate.substr(0, place));
  page += DataElement("glint-run", run);
  page += DataElement("glint-data", data);
  return page.append(kReportTemplate.substr(place + kPlace.size()));
}

}  // namespace glint
