#include "mba_vo/io/map_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "io/temporary_folder.h"
#include "support/rendered_room.h"

namespace mba_vo::map_file_test {
namespace {

/// Two keyframes with all that can be set.
SavedMap exampleMap() {
  SavedMap map;
  map.metric = true;
  map.usual_error = 0.31;
  for (KeyframeId id : {3U, 7U}) {
    const SimulatedFrame rendered = test::roomView(static_cast<int>(id));
    cv::Mat1f image = test::toFloat(rendered.sharp);
    image(cv::Rect(0, 0, 5, 4)).setTo(std::nanf(""));
    auto reference = test::makeReference(rendered, image);
    reference->id = {2, id, 9};
    reference->mid_exposure_ns = 1'000'000'000LL * id;
    reference->T_map_reference = rendered.T_world_mid;
    reference->image_xi << 0.01, 0.02, 0.03, 0.04, 0.05, 0.06;
    reference->motion.velocity << 1, 2, 3, 4, 5, 6;
    reference->motion.acceleration << 6, 5, 4, 3, 2, 1;
    reference->brightness = {0.1, -2.0};
    reference->image_correction.values.setConstant(1e-3);
    reference->correction.values.setConstant(2e-3);
    reference->exposure = 0.02;
    map.keyframes.emplace_back(*reference, *test::makeFrame(image, reference->mid_exposure_ns, 0.02, id));
  }
  return map;
}

std::string contentOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void put(const std::string& file, const std::string& content) { std::ofstream(file, std::ios::binary) << content; }

std::string complaintAbout(const std::string& file) {
  try {
    readMap(file);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(MapFile, HasAllOfAMapToTheLastBit) {
  const TemporaryFolder folder;
  const SavedMap map = exampleMap();
  writeMap(folder.file("room.map"), map);
  const SavedMap read = readMap(folder.file("room.map"));
  EXPECT_EQ(read.metric, map.metric);
  EXPECT_EQ(read.usual_error, map.usual_error);
  ASSERT_EQ(read.keyframes.size(), map.keyframes.size());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    const ArchivedKeyframe &a = map.keyframes[k], &b = read.keyframes[k];
    EXPECT_EQ(cv::norm(a.image, b.image, cv::NORM_INF), 0.0);
    EXPECT_EQ(a.frame_sequence, b.frame_sequence);
    EXPECT_EQ(a.stamp_ns, b.stamp_ns);
    EXPECT_EQ(a.levels, b.levels);
    EXPECT_EQ(a.image_exposure, b.image_exposure);
    EXPECT_EQ(a.camera.fx, b.camera.fx);
    EXPECT_EQ(a.camera.row_time, b.camera.row_time);
    const Reference &r = a.reference, &s = b.reference;
    EXPECT_EQ(r.id.keyframe_id, s.id.keyframe_id);
    EXPECT_EQ(r.T_map_reference.log(), s.T_map_reference.log());
    EXPECT_EQ(r.image_xi, s.image_xi);
    EXPECT_EQ(r.motion.velocity, s.motion.velocity);
    EXPECT_EQ(r.motion.acceleration, s.motion.acceleration);
    EXPECT_EQ(r.brightness.a, s.brightness.a);
    EXPECT_EQ(r.brightness.b, s.brightness.b);
    EXPECT_EQ(r.image_correction, s.image_correction);
    EXPECT_EQ(r.correction, s.correction);
    EXPECT_EQ(r.exposure, s.exposure);
    EXPECT_EQ(s.metric, map.metric);
    ASSERT_EQ(r.points.size(), s.points.size());
    for (std::size_t i = 0; i < r.points.size(); ++i) {
      EXPECT_EQ(r.points[i].pixel, s.points[i].pixel);
      EXPECT_EQ(r.points[i].inverse_depth, s.points[i].inverse_depth);
      EXPECT_EQ(r.points[i].variance, s.points[i].variance);
    }
  }
}

TEST(MapFile, HasKeyframesOfImagesThatWereBinnedOnTheWay) {
  const TemporaryFolder folder;
  SavedMap map = exampleMap();
  ArchivedKeyframe& last = map.keyframes.back();
  last.camera = last.camera.halved();
  cv::resize(last.image.clone(), last.image, {last.camera.width, last.camera.height});
  for (ReferencePoint& point : last.reference.points) point.pixel *= 0.5F;
  writeMap(folder.file("room.map"), map);
  EXPECT_EQ(readMap(folder.file("room.map")).keyframes.back().camera.width, last.camera.width);
  last.camera.width -= 1;
  last.image = last.image.colRange(0, last.camera.width).clone();
  writeMap(folder.file("room.map"), map);
  EXPECT_NE(complaintAbout(folder.file("room.map")).find("images of different sizes"), std::string::npos);
}

TEST(MapFile, KeyframesLieBeforeAnyRun) {
  const TemporaryFolder folder;
  writeMap(folder.file("room.map"), exampleMap());
  const SavedMap read = readMap(folder.file("room.map"));
  EXPECT_EQ(read.keyframes[1].reference.mid_exposure_ns, kBeforeAnyRun);
  EXPECT_EQ(read.keyframes[0].reference.mid_exposure_ns, kBeforeAnyRun - 4'000'000'000LL);
  SavedMap years_later = read;
  years_later.keyframes[1].reference.mid_exposure_ns = 1'700'000'000'000'000'000LL;
  moveBeforeAnyRun(years_later);
  EXPECT_EQ(years_later.keyframes[1].reference.mid_exposure_ns, kBeforeAnyRun);
  EXPECT_EQ(years_later.keyframes[0].reference.mid_exposure_ns, kBeforeAnyRun - 60'000'000'000LL);
}

TEST(MapFile, ADamagedFileIsRefusedAndLeftAsItIs) {
  const TemporaryFolder folder;
  const std::string file = folder.file("room.map");
  writeMap(file, exampleMap());
  const std::string whole = contentOf(file);
  cv::RNG random(7);
  for (int i = 0; i < 200; ++i) {
    std::string spoilt = whole;
    const auto at = static_cast<std::size_t>(random.uniform(0, static_cast<int>(whole.size())));
    if (i % 2 == 0) {
      spoilt.resize(at);
    } else {
      spoilt[at] = static_cast<char>(spoilt[at] ^ (1 << random.uniform(0, 8)));
    }
    put(file, spoilt);
    const std::string complaint = complaintAbout(file);
    EXPECT_EQ(complaint.find(file), 0U) << complaint;
    EXPECT_GT(complaint.size(), file.size() + 10);
    EXPECT_EQ(contentOf(file), spoilt);
  }
}

TEST(MapFile, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string file = folder.file("room.map");
  writeMap(file, exampleMap());
  const std::string whole = contentOf(file);
  EXPECT_NE(complaintAbout(folder.file("none.map")).find("cannot be read: No such file"), std::string::npos);
  put(file, "%YAML:1.0");
  EXPECT_NE(complaintAbout(file).find("is no map"), std::string::npos);
  put(file, whole.substr(0, whole.size() / 2));
  EXPECT_NE(complaintAbout(file).find("is cut off"), std::string::npos);
  std::string damaged = whole;
  damaged[whole.size() / 2] ^= 1;
  put(file, damaged);
  EXPECT_NE(complaintAbout(file).find("is damaged"), std::string::npos);
  std::string later = whole;
  later[9] = 2;  // after the magic and cereal's mark of the byte order
  put(file, later);
  EXPECT_NE(complaintAbout(file).find("is of version 2, this program knows 1 to 1"), std::string::npos)
      << complaintAbout(file);
}

TEST(MapFile, WhatWasThereStaysWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THROW(writeMap(folder.file("no/such/folder.map"), exampleMap()), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder.file("no")));
  const std::string file = folder.file("room.map");
  writeMap(file, exampleMap());
  const std::string whole = contentOf(file);
  EXPECT_THROW(writeMap(file, SavedMap()), std::runtime_error) << "no keyframe";
  std::filesystem::create_directory(file + ".part");  // where it is made first
  EXPECT_THROW(writeMap(file, exampleMap()), std::runtime_error);
  EXPECT_EQ(contentOf(file), whole);
}

}  // namespace
}  // namespace mba_vo::map_file_test
