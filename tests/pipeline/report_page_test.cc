#include "pipeline/report_page.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "io/project_images.h"
#include "pipeline/page_parts.h"
#include "tests/pipeline/program.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Base64, AsInRfc4648) {
  const std::pair<const char*, const char*> pairs[] = {{"", ""},        {"f", "Zg=="},        {"fo", "Zm8="},
                                                       {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : pairs) EXPECT_EQ(Base64(bytes), text);
  EXPECT_EQ(Base64(std::string_view("\xff\xfe\x00", 3)), "//4A");
}

TriangleMesh MakeSphere(double radius) {
  TriangleMesh mesh = testing::Icosphere(3);
  mesh.normals = mesh.vertices;
  for (Eigen::Vector3d& v : mesh.vertices) v *= radius;
  return mesh;
}

// The text of the data element `id`.
std::string Element(const std::string& page, const std::string& id) {
  const std::string open = "id=\"" + id + "\">";
  const size_t begin = page.find(open);
  EXPECT_NE(begin, std::string::npos) << id;
  return page.substr(begin + open.size(), page.find("</script>", begin) - begin - open.size());
}

// Two views, one of them without its photograph, a sphere of radius 1 refined from one of radius 0.9.
struct Fixture {
  RunSummary summary;
  Config config;
  Scene scene;
  TriangleMesh seed = MakeSphere(0.9), mesh = MakeSphere(1);
  RefineResult refined;
  MemoryImages images{{cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(90)), cv::Mat()}};

  explicit Fixture(const std::string& name) {
    summary.outcome = "done";
    summary.model = "/data/vase/sparse/0";
    summary.num_views = 2;
    summary.notes = {"note </script><script>alert(1)</script>"};
    summary.command = "glint run '" + name + "'";
    summary.times = {{"refine", 1.5, false}};
    for (const std::string& view_name : {name, std::string("b.jpg")}) {
      View& view = scene.views.emplace_back();
      view.name = view_name;
      view.camera = {1, CameraModel::kSimplePinhole, 64, 48, {60, 32, 24}};
      view.cam_from_world.translation = {0, 0, 4};
    }
    refined.mesh = mesh;
    refined.mesh.confidence.assign(mesh.vertices.size(), 0.5f);
    Highlight& highlight = refined.highlights.emplace_back();
    highlight.px = {20, 10};
    highlight.covariance_px = highlight.moments_px = Eigen::Matrix2d::Identity();
    highlight.status = HighlightStatus::kStaysPut;
  }
  std::string Page(size_t max_faces = 100000) const {
    return ReportPage({summary, config, scene, images, seed, refined}, Progress::Silent(), {.max_faces = max_faces});
  }
};

TEST(ReportPage, MarkupInNamesIsNoMarkup) {
  const std::string name = "</script><!--<script>alert('&amp;')\xff\".jpg";
  const std::string page = Fixture(name).Page(), plain = Fixture("a.jpg").Page();
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  const auto count = [](const std::string& text, const char* part) {
    size_t n = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  for (const char* part : {"<script", "</script", "<!--", "<"})
    EXPECT_EQ(count(page, part), count(plain, part)) << part;
  const auto data = nlohmann::json::parse(Element(page, "glint-data"));
  EXPECT_EQ(data["photos"][0]["name"], "</script><!--<script>alert('&amp;')\uFFFD\".jpg");
  EXPECT_EQ(data["report"]["notes"][0], "note </script><script>alert(1)</script>");
}

TEST(ReportPage, NothingFromElsewhere) {
  const std::string page = Fixture("a.jpg").Page();
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  for (const char* part : {" src=\"", "<link", "@import", "url("}) EXPECT_THAT(page, Not(HasSubstr(part)));
}

TEST(ReportPage, OnlyTheRunElementDiffersFromRunToRun) {
  Fixture fixture("a.jpg");
  std::string first = fixture.Page();
  fixture.summary.command = "glint run elsewhere";
  fixture.summary.times = {{"refine", 2.5, false}};
  std::string second = fixture.Page();
  EXPECT_NE(first, second);
  for (std::string* page : {&first, &second}) {
    const std::string run = Element(*page, "glint-run");
    page->replace(page->find(run), run.size(), "");
  }
  EXPECT_TRUE(first == second);
}

TEST(ReportPage, MeshesSayWhatTheyAre) {
  const auto data = nlohmann::json::parse(Element(Fixture("a.jpg").Page(), "glint-data"));
  EXPECT_EQ(data["project"], "vase");
  const auto& after = data["after"];
  EXPECT_EQ(after["faces"], after["full_faces"]);
  // From the sphere of 0.9 to that of 1, whose box has a diagonal of 2 √3.
  const double diagonal = data["frame"]["diagonal"];
  EXPECT_NEAR(diagonal, 2 * std::sqrt(3.0), 0.02);
  EXPECT_NEAR(after["attributes"]["moved_rel"]["max"].get<double>() * diagonal, 0.1, 0.01);
  EXPECT_NEAR(data["before"]["attributes"]["moved_rel"]["min"].get<double>() * diagonal, -0.1, 0.01);
  EXPECT_NEAR(after["attributes"]["curvature"]["max"].get<double>() / diagonal, 1, 0.05);
  EXPECT_EQ(data["photos"][0]["highlights"][0][6], static_cast<int>(HighlightStatus::kStaysPut));
  EXPECT_FALSE(data["photos"][0]["jpeg"].get<std::string>().empty());
  EXPECT_EQ(data["photos"][1]["jpeg"], "");
}

TEST(ReportPage, LargeMeshesAreSimplifiedAndSaySo) {
  const Fixture fixture("a.jpg");
  const auto data = nlohmann::json::parse(Element(fixture.Page(200), "glint-data"));
  const auto& after = data["after"];
  EXPECT_LE(after["faces"], 200);
  EXPECT_GE(after["faces"], 150);
  EXPECT_EQ(after["full_faces"], fixture.mesh.faces.size());
  EXPECT_NEAR(after["attributes"]["confidence"]["min"], 0.5, 1e-6);
}

TEST(ReportPage, ARunThatGaveUpHasAPageToo) {
  Fixture fixture("a.jpg");
  fixture.summary.outcome = "no highlights found in any image";
  fixture.seed = {};
  fixture.refined = {};
  const auto data = nlohmann::json::parse(Element(fixture.Page(), "glint-data"));
  EXPECT_TRUE(data["after"].is_null());
  EXPECT_TRUE(data["before"].is_null());
  EXPECT_EQ(data["advice"][0]["level"], "problem");
}

// The committed page is the one that its sources make: build.mjs writes their hash into it.
TEST(ReportPage, TemplateIsUpToDate) {
  const std::string folder = GLINT_SOURCE_DIR "/pipeline/report_assets";
  const std::string command = "cd '" + folder + "' && cat $(LC_ALL=C ls src/* ) build.mjs package.json | sha256sum";
  FILE* pipe = ::popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  char hash[65] = {};
  ASSERT_EQ(std::fread(hash, 1, 64, pipe), 64u);
  ::pclose(pipe);
  EXPECT_THAT(ReadText(folder + "/report_template.html").substr(0, 400), HasSubstr(hash))
      << "run scripts/build_report_assets";
}

}  // namespace
}  // namespace glint
