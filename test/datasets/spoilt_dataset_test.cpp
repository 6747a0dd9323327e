#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/miniature.h"
#include "mba_vo/datasets/dataset.h"

namespace mba_vo::spoilt_dataset_test {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;

/// One that is to be spoilt: how, and what the message must have.
struct Spoilt {
  std::string file;                // below the root
  std::string content;             // instead of what is in it; "" = it is removed
  std::vector<std::string> parts;  // of the message
};

/// Everything that can go wrong when a recording is opened and read.
std::string errorOf(const std::string& folder) {
  return messageOf([&] {
    const Dataset dataset = openDataset(folder);
    while (dataset.reader->next()) {
    }
  });
}

void expectMessages(const std::function<void(const TemporaryFolder&, const std::string&)>& write,
                    const std::vector<Spoilt>& variants, const std::string& name) {
  EXPECT_GE(variants.size(), 5U);
  const TemporaryFolder good;
  write(good, name);
  EXPECT_EQ(errorOf(good.file(name)), "nothing thrown");
  for (const Spoilt& spoilt : variants) {
    const TemporaryFolder folder;
    write(folder, name);
    if (spoilt.content.empty()) {
      EXPECT_GT(fs::remove_all(folder.file(name + "/" + spoilt.file)), 0U) << spoilt.file;
    } else {
      folder.write(name + "/" + spoilt.file, spoilt.content);
    }
    const std::string message = errorOf(folder.file(name));
    for (const std::string& part : spoilt.parts) EXPECT_THAT(message, HasSubstr(part)) << spoilt.file;
  }
}

TEST(SpoiltDataset, TumRgbd) {
  expectMessages(
      writeTumRgbd,
      {{"rgb.txt", "1305031229.528748\n", {"rgb.txt:1: 1 columns", "'time[s] file'"}},
       {"rgb.txt", "# freiburg1\nsoon rgb/1305031229.528748.png\n", {"rgb.txt:2: time 'soon'"}},
       {"rgb.txt", "# freiburg1\n1.5 rgb/none.png\n", {"rgb.txt:2", "rgb/none.png: no such image"}},
       {"rgb.txt", "# freiburg1\n", {"rgb.txt: lists no image"}},
       {"rgb.txt", "1305031229.528748 rgb/1305031229.528748.png\n", {"no calibration", "freiburg1", "--calibration"}},
       {"rgb", "", {"rgb.txt:4", "no such image"}},
       {"calibration.txt", "517.3 516.5 318.6\n", {"calibration.txt:1: 3 values"}}},
      "my_recording");
}

TEST(SpoiltDataset, Eth3d) {
  expectMessages(writeEth3d,
                 {{"calibration.txt", "726.2 726.2 359.2 x\n", {"calibration.txt:1: ", "'x'"}},
                  {"calibration.txt", "-726.2 726.2 359.2 202.5\n", {"calibration.txt:1: ", "fx is -726.2"}},
                  {"calibration.txt", "", {"no calibration", "calibration.txt (ETH3D)"}},
                  {"rgb.txt", "5455.183914 rgb/5455.183914.png 3\n", {"rgb.txt:1: 3 columns"}},
                  {"rgb/5455.220805.png", "", {"rgb.txt:2: ", "5455.220805.png: no such image"}}},
                 "table_1");
}

TEST(SpoiltDataset, Euroc) {
  expectMessages(
      writeEuroc,
      {{"mav0/cam0/data.csv", "#timestamp [ns],filename\n14x,a.png\n", {"data.csv:2", "a.png: no such image"}},
       {"mav0/cam0/data.csv", "1403715273.26,1403715273262142976.png\n", {"data.csv:1: time [ns] '1403715273.26'"}},
       {"mav0/cam0/data.csv", "#\n1403715273262142976\n", {"data.csv:2: 1 columns", "'time[ns],file'"}},
       {"mav0/cam0/data.csv", "#timestamp [ns],filename\n", {"data.csv: lists no image"}},
       {"mav0/cam0/data", "", {"cam0/data: no such folder"}},
       {"mav0/cam0/sensor.yaml", "", {"cam0: no calibration", "sensor.yaml", "--calibration"}},
       {"mav0/cam0/sensor.yaml", "resolution: [752, 480]\nintrinsics: [458, 457]\n", {"sensor.yaml:2: 'intrinsics'"}},
       {"mav0/cam0", "", {"mav0/cam0: no such folder"}}},
      "V1_01_easy");
}

TEST(SpoiltDataset, TumVi) {
  expectMessages(
      writeTumVi,
      {{"dso/cam0/times.txt", "# head\n1520530308199447626 1520530308.2 1.5 3\n", {"times.txt:2: 4 columns"}},
       {"dso/cam0/times.txt", "1520530308199447626 1520530308.2 long\n", {"times.txt:1: exposure 'long'"}},
       {"dso/cam0/times.txt", "0 1520530308.2 1.5\n", {"times.txt: its ids", "1520530308199447626"}},
       {"dso/camchain.yaml", "cam0:\n  intrinsics: [1, 1, 1, 1]\n", {"camchain.yaml:2: 'cam0.resolution' is missing"}},
       {"dso/camchain.yaml", "", {"no calibration", "dso/camchain.yaml", "dso/cam0/camera.txt"}},
       {"mav0/cam0/data/1520530308249450626.png", "", {"data.csv:3: ", "no such image"}}},
      "room");
}

TEST(SpoiltDataset, TumMono) {
  expectMessages(
      writeTumMono,
      {{"camera.txt", "FOV 0.3 0.4 0.5\n1280 1024\n", {"camera.txt:1: FOV has 3 values"}},
       {"camera.txt", "", {"camera.yaml: cannot be read"}},
       {"times.txt", "00000 1464106180.51 3.9 7\n", {"times.txt:1: 4 columns"}},
       {"times.txt", "00000 1464106180.51 3.9\n00007 1464106180.55 3.9\n", {"images/000007.*: no such image"}},
       {"times.txt", "", {"times.txt: cannot be read"}},
       {"images", "", {"images: no such folder"}},
       {"images/00001.jpg", "", {"images/000001.*: no such image"}}},
      "sequence_01");
  const TemporaryFolder folder;
  writeTumMono(folder, "m");
  fs::remove_all(folder.file("m/images"));
  folder.write("m/images.zip", "PK");
  EXPECT_THAT(errorOf(folder.file("m")), testing::AllOf(HasSubstr("unzip -d"), HasSubstr("m/images.zip")));
}

TEST(SpoiltDataset, SevenScenes) {
  expectMessages(writeSevenScenes,
                 {{"frame-00000x.color.png", "x", {"frame-00000x.color.png: number of the frame '00000x'"}},
                  {"camera.yaml", "image_width: 640\n", {"camera.yaml:1: 'image_height' is missing"}},
                  {"camera.txt",
                   "Pinhole 525 525 320 240 0\n320 240\n",
                   {"000000.color.png: image is 640x480", "camera.txt says 320x240"}},
                  {"camera.ini", "[image]\nwidth\n640\n", {"camera.ini: 'height' is missing"}},
                  {"camchain.yaml", "cam0:\n  camera_model: omni\n", {"camchain.yaml:2: 'cam0.camera_model' is omni"}}},
                 "seq-02");
}

TEST(SpoiltDataset, AnImageThatCannotBeReadDoesNotEndTheRecording) {
  const TemporaryFolder folder;
  writeEth3d(folder, "e");
  folder.write("e/rgb/5455.183914.png", "nonsense");
  const Dataset dataset = openDataset(folder.file("e"));
  EXPECT_EQ(dataset.reader->calibration().width, 739) << "by the next image";
  EXPECT_THAT(dataset.reader->next()->problem, HasSubstr("5455.183914.png: not a readable image"));
  EXPECT_EQ(dataset.reader->next()->problem, "");
}

TEST(SpoiltDataset, AFolderOfNoKnownFormIsToldWhatWasLookedFor) {
  const TemporaryFolder folder;
  EXPECT_THAT(errorOf(folder.file("none")), HasSubstr("none: no such folder"));
  folder.write("empty/readme.md", "nothing here");
  const std::string message = errorOf(folder.file("empty"));
  for (const char* part : {"rgb.txt", "mav0/cam0/data.csv", "times.txt", "frame-000000.color.png"}) {
    EXPECT_THAT(message, HasSubstr(part));
  }
}

}  // namespace
}  // namespace mba_vo::spoilt_dataset_test
