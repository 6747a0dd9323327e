#include "mba_vo/odometry/config_yaml.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/temporary_folder.h"

namespace mba_vo::config_yaml_test {
namespace {

using testing::HasSubstr;

std::string errorFor(const std::string& yaml) {
  OdometryConfig config;
  return messageOf([&] { applyYaml(YAML::Load(yaml), config); });
}

std::string asYaml(const OdometryConfig& config) {
  std::ostringstream text;
  writeConfig(config, text);
  return text.str();
}

/// Changes every option to another allowed value.
struct Changer {
  void operator()(const char*, int& field, int min, int max, const char*) {
    field = field == max ? min : field + 1;
    ++count;
  }
  void operator()(const char*, double& field, double min, double max, const char*) {
    field = 0.5 * (field + (field == max ? min : max));
    ++count;
  }
  void operator()(const char*, bool& field, const char*) {
    field = !field;
    ++count;
  }
  void operator()(const char*, std::string& field, const char*) {
    field += "a \"quoted\": text # here";
    ++count;
  }
  template <typename Nested>
  void section(const char*, Nested& nested) {
    Nested::describe(nested, *this);
  }
  int count = 0;
};

TEST(ConfigYaml, AVignetteThatIsToldIsNotToBeFound) {
  OdometryConfig config;
  finalize(config);
  EXPECT_FALSE(config.mapper.vignette_told);
  applyYaml(YAML::Load("image: {vignette_file: vignette.png}"), config);
  EXPECT_TRUE(config.mapper.vignette_told);
}

TEST(ConfigYaml, OptionsOfTheFileReplaceDefaultsAndOthersStay) {
  OdometryConfig config;
  const OdometryConfig defaults;
  applyYaml(YAML::Load("{tracker: {max_points: 123}, mapper: {window: {max_keyframes: 5}}, image: {gamma: 2}}"),
            config);
  EXPECT_EQ(config.tracker.max_points, 123);
  EXPECT_EQ(config.mapper.window.max_keyframes, 5);
  EXPECT_DOUBLE_EQ(config.image.gamma, 2.0);
  EXPECT_EQ(config.mapper.window.max_points, defaults.mapper.window.max_points);
}

TEST(ConfigYaml, MapperTracksWithTheTrackersOptions) {
  OdometryConfig config;
  applyYaml(YAML::Load("{tracker: {max_points: 123}}"), config);
  EXPECT_EQ(config.mapper.tracker.max_points, 123);
}

TEST(ConfigYaml, EveryOptionSurvivesWritingAndReading) {
  OdometryConfig changed;
  Changer changer;
  OdometryConfig::describe(changed, changer);
  EXPECT_GT(changer.count, 15);
  EXPECT_NE(asYaml(changed), asYaml(OdometryConfig()));
  OdometryConfig read;
  applyYaml(YAML::Load(asYaml(changed)), read);
  EXPECT_EQ(asYaml(read), asYaml(changed));
}

TEST(ConfigYaml, NoOptionIsFine) {
  for (const char* yaml : {"", "{}", "tracker:", "# only a comment"}) {
    EXPECT_EQ(errorFor(yaml), "nothing thrown") << yaml;
  }
}

TEST(ConfigYaml, UnknownOptionsAreNamedWithWhatIsAllowed) {
  EXPECT_THAT(errorFor("{tracker: {max_point: 5}}"),
              testing::AllOf(HasSubstr("unknown option 'tracker.max_point'"), HasSubstr("max_points")));
  EXPECT_THAT(errorFor("{trakcer: {}}"), testing::AllOf(HasSubstr("'trakcer'"), HasSubstr("mapper, tracker")));
  EXPECT_THAT(errorFor("{mapper: {window: {size: 3}}}"), HasSubstr("'mapper.window.size'"));
  EXPECT_THAT(errorFor("{tracker: {max_points: 50, max_points: 60}}"),
              HasSubstr("'tracker.max_points' is given twice"));
}

TEST(ConfigYaml, ValuesOutOfRangeAreNamedWithTheRange) {
  EXPECT_THAT(errorFor("{tracker: {huber_threshold: 900}}"),
              testing::AllOf(HasSubstr("'tracker.huber_threshold'"), HasSubstr("900"), HasSubstr("0.1 to 255")));
  EXPECT_THAT(errorFor("{tracker: {huber_threshold: .nan}}"), HasSubstr("nan is out of range"));
  EXPECT_THAT(errorFor("{tracker: {max_points: -1}}"), HasSubstr("-1 is out of range"));
}

TEST(ConfigYaml, WrongTypesAreNamed) {
  EXPECT_THAT(errorFor("{tracker: {max_points: 50.5}}"), HasSubstr("'50.5' given, must be a whole number"));
  EXPECT_THAT(errorFor("{tracker: {max_points: [1, 2]}}"), HasSubstr("a list given"));
  EXPECT_THAT(errorFor("{tracker: {huber_threshold: high}}"), HasSubstr("'high' given, must be a number"));
  EXPECT_THAT(errorFor("{tracker: {huber_threshold: }}"), HasSubstr("nothing given"));
  EXPECT_THAT(errorFor("{mapper: {window: {reblur_targets: 7}}}"), HasSubstr("must be true or false"));
  EXPECT_THAT(errorFor("{tracker: 5}"), HasSubstr("section 'tracker': '5' given, must be a map"));
  EXPECT_THAT(errorFor("[1, 2]"), HasSubstr("configuration: a list given"));
}

TEST(ConfigYaml, FilesThatCannotBeReadAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT(messageOf([] { loadConfig("/nonexistent.yaml"); }), HasSubstr("/nonexistent.yaml: cannot be read"));
  const std::string broken = folder.write("broken.yaml", "tracker: {max_points: [");
  EXPECT_THAT(messageOf([&] { loadConfig(broken); }), HasSubstr(broken));
  const std::string wrong = folder.write("wrong.yaml", "tracker: {max_points: -5}");
  EXPECT_THAT(messageOf([&] { loadConfig(wrong); }), testing::AllOf(HasSubstr(wrong), HasSubstr("max_points")));
}

TEST(ConfigYaml, FileWithTheDefaultsIsUpToDate) {
  std::ostringstream file;
  file << std::ifstream(MBA_VO_SOURCE_DIR "/config/default.yaml").rdbuf();
  EXPECT_EQ(file.str(), asYaml(OdometryConfig())) << "run: mba_vo_offline --print-config > config/default.yaml";
}

}  // namespace
}  // namespace mba_vo::config_yaml_test
