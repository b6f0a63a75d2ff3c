#include "light/light_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class LightIo : public ::testing::Test {
 protected:
  LightIo() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / ("glint_light_io_" + std::string(info->name()));
    std::filesystem::create_directories(folder_);
  }
  ~LightIo() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Write(const std::string& text) {
    const auto path = folder_ / "lights.json";
    std::ofstream(path) << text;
    return path;
  }

  // The message that reading `text` fails with.
  std::string Failure(const std::string& text) {
    try {
      ReadLights(Write(text));
    } catch (const InputError& e) {
      EXPECT_THAT(e.path(), HasSubstr("lights.json"));
      return e.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

TEST_F(LightIo, KeepsInWhichImagesALightShinesAndHowLargeItIs) {
  FoundLight found;
  found.light.images = {"a.jpg", "b/c.png"};
  found.angular_size_deg = 7.5;
  WriteFoundLights(folder_ / "lights.json", {found});
  const auto read = ReadFoundLights(folder_ / "lights.json");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].light.images, found.light.images);
  EXPECT_EQ(read[0].angular_size_deg, 7.5);
  EXPECT_TRUE(ShinesIn(read[0].light, "b/c.png"));
  EXPECT_FALSE(ShinesIn(read[0].light, "c.png"));
  EXPECT_TRUE(ShinesIn(Light{}, "c.png"));
  for (const char* images : {"[]", "3", "[1]"})
    EXPECT_THAT(
        Failure(std::string(R"({"lights":[{"type":"distant","frame":"world","direction_to_light":[0,0,1],"images":)") +
                images + "}]}"),
        HasSubstr("images"));
}

TEST_F(LightIo, ReadsBothTypesAndFrames) {
  const auto lights = ReadLights(Write(R"({"lights":[
      {"type":"distant","frame":"world","direction_to_light":[0,3,4]},
      {"type":"point","frame":"camera","position":[0.1,-2,0],"sigma":0.5}]})"));
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0].type, LightType::kDistant);
  EXPECT_EQ(lights[0].frame, LightFrame::kWorld);
  EXPECT_TRUE(lights[0].vector.isApprox(Eigen::Vector3d(0, 0.6, 0.8)));
  EXPECT_EQ(lights[0].sigma, 0);
  EXPECT_EQ(lights[1].type, LightType::kPoint);
  EXPECT_EQ(lights[1].frame, LightFrame::kCamera);
  EXPECT_TRUE(lights[1].vector.isApprox(Eigen::Vector3d(0.1, -2, 0)));
  EXPECT_EQ(lights[1].sigma, 0.5);
}

TEST_F(LightIo, WritesWhatItReads) {
  std::vector<Light> lights(2);
  lights[0].vector = Eigen::Vector3d(0.123456789012345, -0.5, 0.7).normalized();
  lights[0].sigma = 0.25;
  lights[1] = {LightType::kPoint, LightFrame::kCamera, {1e-6, 1e6, -3}, 0};
  const auto path = folder_ / "new" / "out.json";
  WriteLights(path, lights);
  const auto back = ReadLights(path);
  ASSERT_EQ(back.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back[i].type, lights[i].type);
    EXPECT_EQ(back[i].frame, lights[i].frame);
    EXPECT_LT((back[i].vector - lights[i].vector).norm(), 1e-12);
    EXPECT_EQ(back[i].sigma, lights[i].sigma);
  }
}

TEST_F(LightIo, ShortAndLongDirectionsAreNormalised) {
  for (const char* direction : {"[0,0,1e-300]", "[0,0,1e300]", "[0,0,5]"}) {
    const auto lights = ReadLights(Write(std::string(R"({"lights":[{"type":"distant","frame":"world",)") +
                                         R"("direction_to_light":)" + direction + "}]}"));
    EXPECT_TRUE(lights[0].vector.isApprox(Eigen::Vector3d::UnitZ())) << direction;
  }
}

TEST_F(LightIo, NamesTheRecordThatIsWrong) {
  const std::string good = R"({"type":"distant","frame":"world","direction_to_light":[0,0,1]})";
  const auto second = [&](const std::string& light) { return Failure(R"({"lights":[)" + good + "," + light + "]}"); };
  EXPECT_THAT(second(R"({"type":"sun","frame":"world","direction_to_light":[0,0,1]})"),
              AllOf(HasSubstr("light 1"), HasSubstr("\"type\""), HasSubstr("sun")));
  EXPECT_THAT(second(R"({"frame":"world","direction_to_light":[0,0,1]})"), HasSubstr("\"type\" is missing"));
  EXPECT_THAT(second(R"({"type":"distant","direction_to_light":[0,0,1]})"), HasSubstr("\"frame\" is missing"));
  EXPECT_THAT(second(R"({"type":"distant","frame":"world"})"), HasSubstr("\"direction_to_light\" is missing"));
  EXPECT_THAT(second(R"({"type":"point","frame":"world"})"), HasSubstr("\"position\" is missing"));
  EXPECT_THAT(second(R"({"type":"distant","frame":"world","direction_to_light":[0,0,0]})"), HasSubstr("zero length"));
  EXPECT_THAT(second(R"({"type":"distant","frame":"world","direction_to_light":[0,1]})"), HasSubstr("3 numbers"));
  EXPECT_THAT(second(R"({"type":"distant","frame":"world","direction_to_light":[0,"x",1]})"), HasSubstr("3 numbers"));
  EXPECT_THAT(second(R"({"type":"distant","frame":"world","direction_to_light":[0,null,1]})"), HasSubstr("3 numbers"));
  EXPECT_THAT(second(R"({"type":"distant","frame":"world","direction_to_light":[0,0,1],"color":1})"),
              HasSubstr("unknown key \"color\""));
  EXPECT_THAT(second(R"({"type":"distant","frame":"world","direction_to_light":[0,0,1],"sigma_deg":-1})"),
              HasSubstr("sigma_deg"));
  EXPECT_THAT(second("7"), HasSubstr("expected an object"));
}

TEST_F(LightIo, RefusesWhatIsNoLightsFile) {
  EXPECT_THAT(Failure(""), HasSubstr("not valid JSON"));
  EXPECT_THAT(Failure(R"({"lights":[{"type":"distant","frame":"world","direction_to_light":[NaN,0,1]}]})"),
              HasSubstr("not valid JSON"));
  EXPECT_THAT(Failure(R"({"lights":[{"type":"distant","frame":"world","direction_to_light":[1e999,0,1]}]})"),
              HasSubstr("not valid JSON"));
  EXPECT_THAT(Failure("[]"), HasSubstr("\"lights\""));
  EXPECT_THAT(Failure(R"({"lights":3})"), HasSubstr("\"lights\""));
  EXPECT_THAT(Failure(R"({"lights":[]})"), HasSubstr("empty"));
  EXPECT_THAT(Failure(R"({"lights":[], "lamp":1})"), HasSubstr("unknown key \"lamp\""));
  EXPECT_THROW(ReadLights(folder_ / "missing.json"), InputError);
}

}  // namespace
}  // namespace glint
