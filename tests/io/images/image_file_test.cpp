// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/images/image_file.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class ImageFiles : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    const auto file = folder_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file;
  }
  ImageFile stated(const std::filesystem::path& file, ImageFormat format) {
    ImageFile f;
    f.file = file, f.format = format;
    f.unit = ImageUnit::mm, f.y = ImageY::up, f.origin = ImageOrigin::middle;
    return f;
  }
  static std::string fault_of(const ImageFile& f) {
    try {
      read_image_file(f);
    } catch (const core::Error& e) {
      return e.text();
    }
    return {};
  }
  test::TemporaryFolder folder_;
};

TEST_F(ImageFiles, BingoWithAndWithoutEnds) {
  // As Pix4D writes it, and as BINGO itself, with -99.
  for (const char* end : {"\n", "-99\n"}) {
    const auto file = write("image.dat", std::string("P1060498 H_8.07_6.0525\n1006 -1.90643 1.83493\n1020 2.00132 -0.797681\n") + end +
                                             "P1060499 H_8.07_6.0525\n1006 -2.42102 1.87814\n");
    const ImageData d = read_image_file(stated(file, ImageFormat::bingo));
    EXPECT_EQ(d.images, (std::vector<std::string>{"P1060498", "P1060499"}));
    EXPECT_EQ(d.points, (std::vector<std::string>{"1006", "1020"}));
    ASSERT_EQ(d.marks.size(), 3u);
    EXPECT_EQ(d.marks[2].image, 1u);
    EXPECT_EQ(d.marks[2].point, 0u);
    EXPECT_DOUBLE_EQ(d.marks[2].x, -2.42102);
    EXPECT_DOUBLE_EQ(d.marks[1].y, -0.797681);
  }
}

TEST_F(ImageFiles, PatB) {
  const auto file = write("block.im", "4001 153.012 1\n 17 -1906.4 1834.9 0\n 18 2001.3 -797.6\n-99\n4002 153.012\n17 5 6\n-99\n");
  ImageFile f = stated(file, ImageFormat::patb);
  f.unit = ImageUnit::um;
  const ImageData d = read_image_file(f);
  EXPECT_EQ(d.images, (std::vector<std::string>{"4001", "4002"}));
  ASSERT_EQ(d.marks.size(), 3u);
  EXPECT_DOUBLE_EQ(d.marks[0].x, -1906.4);
  EXPECT_EQ(d.unit, ImageUnit::um);
  f.file = write("cut.im", "4001 153.012\n17 5 6\n4002\n");
  EXPECT_NE(fault_of(f).find("cut.im:3: neither a point nor the end"), std::string::npos) << fault_of(f);
}

TEST_F(ImageFiles, CsvWithItsColumns) {
  ImageFile f = stated(write("p.csv", "photo,id,u,v\na.jpg,t1,10.5,20\nb.jpg,t1,11,21\n"), ImageFormat::csv);
  f.image_column = "photo", f.point_column = "id", f.x_column = "u", f.y_column = "v";
  const ImageData d = read_image_file(f);
  ASSERT_EQ(d.marks.size(), 2u);
  EXPECT_DOUBLE_EQ(d.marks[0].x, 10.5);
  EXPECT_EQ(d.marks[1].line, 3u);
  f.file = write("q.csv", "photo,id,u,v\na.jpg,t1,x,20\n");
  EXPECT_NE(fault_of(f).find("q.csv:2"), std::string::npos);
}

TEST_F(ImageFiles, WhatAFormatLeavesOpenMustBeStated) {
  ImageFile f = stated(write("p.csv", "image,point,x,y\na,t,1,2\n"), ImageFormat::csv);
  f.unit.reset();
  EXPECT_NE(fault_of(f).find("unit"), std::string::npos);
  f.unit = ImageUnit::mm, f.y.reset();
  EXPECT_NE(fault_of(f).find("y axis"), std::string::npos);
  f.y = ImageY::up, f.origin.reset();
  EXPECT_NE(fault_of(f).find("origin"), std::string::npos);
  f.format = ImageFormat::colmap;
  EXPECT_NE(fault_of(f).find("fixed by the format colmap"), std::string::npos);
}

/// A model with a camera of every number, two images, three points.
ImageData model() {
  ImageData d;
  d.cameras.push_back({"1", 4000, 3000, 3200.25, 3200.25, 2001.5, 1498.75, -0.05, 0.01, -0.002, 0.0003, -0.0004});
  d.images = {"a b.jpg", "c.jpg"};
  d.camera_of = {0, 0};
  for (std::uint32_t i = 0; i < 2; ++i)
    d.poses.push_back({i,
                       (Eigen::AngleAxisd(0.3 + i, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()) *
                        Eigen::AngleAxisd(2.5 - i, Eigen::Vector3d::UnitZ()))
                           .toRotationMatrix(),
                       {100.125 + 50.0 * i, -200.5, 812.0625}});
  d.points = {"7", "8", "9"};
  d.marks = {{0, 0, 1000.25, 2000.5, 0}, {0, 1, 10.5, 20.75, 0}, {1, 0, 1500, 1600, 0}, {1, 2, 3, 4, 0}};
  return d;
}

TEST_F(ImageFiles, ColmapThereAndBack) {
  const ImageData d = model();
  write_colmap(folder_.path() / "sparse", d, {{"7", {1, 2, 3}}, {"8", {4, 5, 6}}, {"9", {7, 8, 9}}});
  ImageFile f;
  f.file = folder_.path() / "sparse", f.format = ImageFormat::colmap;
  const ImageData r = read_image_file(f);
  EXPECT_EQ(r.images, d.images);
  ASSERT_EQ(r.marks.size(), d.marks.size());
  for (size_t k = 0; k < d.marks.size(); ++k) {
    EXPECT_EQ(r.marks[k].x, d.marks[k].x);
    EXPECT_EQ(r.marks[k].y, d.marks[k].y);
  }
  EXPECT_EQ(r.cameras[0].k3, d.cameras[0].k3);
  EXPECT_EQ(r.cameras[0].p2, d.cameras[0].p2);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_LT((r.poses[i].camera_R_frame - d.poses[i].camera_R_frame).norm(), 1e-14);
    EXPECT_LT((r.poses[i].position - d.poses[i].position).norm(), 1e-11);
  }
}

TEST_F(ImageFiles, ColmapsPointsHaveTheirReprojectionErrors) {
  ImageData d;
  d.cameras.push_back({"1", 4000, 3000, 3000.0, 3000.0, 2000.0, 1500.0, 0.1, 0.0, 0.0, 0.01, 0.02});
  d.images = {"a", "b"};
  d.camera_of = {0, 0};
  d.poses = {{0, Eigen::Matrix3d::Identity(), {0, 0, 10}}, {1, Eigen::Matrix3d::Identity(), {1, 0, 10}}};
  d.points = {"7", "8"};
  // The first image sees (1, -2, 0) at (0.1, 0.2), y down: r2 = 0.05, radial 1.005. By OpenCV x = 0.1005 + 2 0.01 0.02 + 0.02 0.07,
  // y = 0.201 + 0.01 0.13 + 2 0.02 0.02. The second one sees it at (0, 0.2): x = 0.02 0.04, y = 0.2 1.004 + 0.01 0.12.
  const double x = 2000.0 + 3000.0 * 0.1023, y = 1500.0 + 3000.0 * 0.2031, x2 = 2000.0 + 3000.0 * 0.0008, y2 = 1500.0 + 3000.0 * 0.202;
  d.marks = {{0, 0, x + 0.3, y - 0.4, 0}, {1, 0, x2, y2 + 0.25, 0}, {0, 1, 2000.0, 1500.0, 0}};
  write_colmap(folder_.path() / "sparse", d, {{"7", {1, -2, 0}}, {"8", {0, 0, -5}}});
  std::ifstream file(folder_.path() / "sparse/points3D.txt");
  std::string line;
  std::getline(file, line);
  for (const double want : {(0.5 + 0.25) / 2.0, 0.0}) {
    int id = 0, r = 0, g = 0, b = 0;
    double X = 0.0, Y = 0.0, Z = 0.0, error = -1.0;
    file >> id >> X >> Y >> Z >> r >> g >> b >> error;
    EXPECT_NEAR(error, want, 1e-9) << id;
    std::getline(file, line);
  }
}

TEST_F(ImageFiles, OpenSfmThereAndBack) {
  const ImageData d = model();
  write_opensfm(folder_.path() / "sfm", d, {{"7", {1, 2, 3}}, {"8", {4, 5, 6}}, {"9", {7, 8, 9}}});
  ImageFile f;
  f.file = folder_.path() / "sfm/tracks.csv", f.format = ImageFormat::opensfm;
  const ImageData r = read_image_file(f);
  EXPECT_EQ(r.images, d.images);
  EXPECT_EQ(r.points, (std::vector<std::string>{"1", "2", "3"}));
  ASSERT_EQ(r.marks.size(), d.marks.size());
  for (size_t k = 0; k < d.marks.size(); ++k) {
    EXPECT_EQ(r.marks[k].image, d.marks[k].image);
    EXPECT_NEAR(r.marks[k].x, d.marks[k].x, 1e-12 * 4000.0);
    EXPECT_NEAR(r.marks[k].y, d.marks[k].y, 1e-12 * 4000.0);
  }
  EXPECT_NEAR(r.cameras[0].fy, d.cameras[0].fy, 1e-11);
  EXPECT_NEAR(r.cameras[0].cy, d.cameras[0].cy, 1e-11);
  EXPECT_EQ(r.cameras[0].k3, d.cameras[0].k3);
  EXPECT_EQ(r.cameras[0].p2, d.cameras[0].p2);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_LT((r.poses[i].camera_R_frame - d.poses[i].camera_R_frame).norm(), 1e-14);
    EXPECT_LT((r.poses[i].position - d.poses[i].position).norm(), 1e-11);
  }
  ImageData tab = model();
  tab.images[0] = "a\tb.jpg";
  EXPECT_THROW(write_opensfm(folder_.path() / "sfm", tab, {}), core::Error);
}

TEST_F(ImageFiles, ColmapAsItsDocumentationHasIt) {
  write("s/cameras.txt", "# Camera list\n1 SIMPLE_RADIAL 3072 2304 2559.81 1536 1152 -0.0218531\n");
  write("s/images.txt",
        "1 0.851773 0.0165051 0.503764 -0.142941 -0.737434 1.02973 3.74354 1 P1180141.JPG\n2362.39 248.498 58396 1784.7 268.254 -1\n");
  ImageFile f;
  f.file = folder_.path() / "s", f.format = ImageFormat::colmap;
  const ImageData d = read_image_file(f);
  ASSERT_EQ(d.marks.size(), 1u);
  EXPECT_EQ(d.points[0], "58396");
  // A point one unit in front of the camera is along the negative third axis here.
  const Eigen::Matrix3d R = Eigen::Quaterniond(0.851773, 0.0165051, 0.503764, -0.142941).normalized().toRotationMatrix();
  const Eigen::Vector3d t(-0.737434, 1.02973, 3.74354), front = R.transpose() * (Eigen::Vector3d::UnitZ() - t);
  EXPECT_LT((d.poses[0].camera_R_frame * (front - d.poses[0].position) + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  write("s/cameras.txt", "1 OPENCV_FISHEYE 3072 2304 2559 2559 1536 1152 0 0 0 0\n");
  EXPECT_NE(fault_of(f).find("OPENCV_FISHEYE, which is not Brown's"), std::string::npos) << fault_of(f);
  for (const char* width : {"0", "4294967296"}) {
    write("s/cameras.txt", std::string("1 SIMPLE_RADIAL ") + width + " 2304 2559.81 1536 1152 -0.0218531\n");
    EXPECT_NE(fault_of(f).find(std::string("WIDTH is not a number of pixels: ") + width), std::string::npos) << fault_of(f);
  }
}

TEST_F(ImageFiles, OpenSfm) {
  write("o/reconstruction.json",
        R"([{"cameras":{"v2":{"projection_type":"brown","width":1368,"height":912,"focal_x":0.66,"focal_y":0.67,"c_x":-0.0015,"c_y":0.0047,
           "k1":-0.26,"k2":0.1,"p1":0.0007,"p2":0.0003,"k3":-0.02}},
           "shots":{"a.tif":{"rotation":[3.0,0.1,-0.2],"translation":[1.0,2.0,3.0],"camera":"v2"}},"points":{}}])");
  ImageFile f;
  f.format = ImageFormat::opensfm;
  f.file =
      write("o/tracks.csv",
            "OPENSFM_TRACKS_VERSION_v2\na.tif\t17\t3\t0.25\t-0.125\t0.004\t10\t20\t30\t-1\t-1\nb.tif\t17\t3\t0\t0\t0\t1\t2\t3\t-1\t-1\n");
  const ImageData d = read_image_file(f);
  ASSERT_EQ(d.images.size(), 1u);
  ASSERT_EQ(d.marks.size(), 1u);  // b.tif is not oriented
  EXPECT_DOUBLE_EQ(d.marks[0].x, 684.0 + 0.25 * 1368.0);
  EXPECT_DOUBLE_EQ(d.marks[0].y, 456.0 - 0.125 * 1368.0);
  EXPECT_DOUBLE_EQ(d.cameras[0].fy, 0.67 * 1368.0);
  EXPECT_DOUBLE_EQ(d.cameras[0].cx, 684.0 - 0.0015 * 1368.0);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(Eigen::Vector3d(3.0, 0.1, -0.2).norm(), Eigen::Vector3d(3.0, 0.1, -0.2).normalized()).toRotationMatrix();
  EXPECT_LT((d.poses[0].position + R.transpose() * Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
}

TEST_F(ImageFiles, OpenSfmValuesOfAnotherKindAreNamed) {
  ImageFile f;
  f.format = ImageFormat::opensfm;
  f.file = write("o/tracks.csv", "a.tif\t17\t3\t0.25\t-0.125\n");
  const auto with = [&](const std::string& cameras, const std::string& shots) {
    write("o/reconstruction.json", "[{\"cameras\":" + cameras + ",\"shots\":" + shots + "}]");
    return fault_of(f);
  };
  EXPECT_NE(with("[]", "{}").find("reconstruction.json:1:12: \"cameras\" of the reconstruction is not a table"), std::string::npos)
      << with("[]", "{}");
  const std::string camera = R"({"c":{"projection_type":"brown","width":10,"height":10}})";
  EXPECT_NE(with(camera, "3").find("\"shots\" of the reconstruction is not a table"), std::string::npos);
  EXPECT_NE(with(camera, R"({"a.tif":{"camera":1}})").find("\"camera\" of shot a.tif is not a text"), std::string::npos);
  EXPECT_NE(with(R"({"c":{"projection_type":2}})", "{}").find("is not a text"), std::string::npos);
  EXPECT_NE(with(R"({"c":{"projection_type":"brown","width":1e12}})", "{}").find("\"width\" of camera c is not a number of pixels"),
            std::string::npos);
}

constexpr const char* blocks_head =
    "<BlocksExchange version=\"2.1\"><Block><Photogroups><Photogroup><Name>UCX</Name><ImageDimensions><Width>9420</Width>"
    "<Height>14430</Height></ImageDimensions><SensorSize>103.896</SensorSize><FocalLength>100.735601903992</FocalLength>"
    "<CameraOrientation>XRightYDown</CameraOrientation><PrincipalPoint><x>4683.755692</x><y>7223.0141002</y></PrincipalPoint>"
    "<Distortion><K1>-0.001</K1><K2>0.0056</K2><K3>-0.0098</K3><P1>0.1</P1><P2>0.2</P2></Distortion>";

TEST_F(ImageFiles, BlocksExchange) {
  const std::string photo =
      "<Photo><Id>146</Id><ImagePath>D:\\data\\071_2810.jpg</ImagePath><Pose><Rotation><M_00>-0.9999982912233401</M_00>"
      "<M_01>-0.001636319085375301</M_01><M_02>-0.0008602425863163225</M_02><M_10>-0.001631068695467463</M_10>"
      "<M_11>0.9999802528616577</M_11><M_12>-0.00606906089589293</M_12><M_20>0.0008701565192966738</M_20>"
      "<M_21>-0.006067647409696231</M_21><M_22>-0.9999812130648239</M_22></Rotation><Center><x>651999.7</x><y>6863073.6</y>"
      "<z>1318.9</z></Center></Pose></Photo></Photogroup></Photogroups>";
  const std::string points =
      "<ControlPoints><ControlPoint><Name>T1</Name></ControlPoint><ControlPoint><Name>G1</Name><Measurement><PhotoId>146</"
      "PhotoId><x>3296.56</x><y>9253.75</y></Measurement>"
      "</ControlPoint></ControlPoints><TiePoints><TiePoint><Measurement><PhotoId>146</PhotoId><x>0</x><y>0</y></Measurement></TiePoint>"
      "</TiePoints></Block></BlocksExchange>";
  ImageFile f;
  f.format = ImageFormat::blocks_exchange;
  f.file = write("block.xml", blocks_head + photo + points);
  const ImageData d = read_image_file(f);
  EXPECT_EQ(d.images, std::vector<std::string>{"071_2810.jpg"});
  EXPECT_EQ(d.points, (std::vector<std::string>{"T1", "G1", "T1'"}));
  EXPECT_EQ(d.numbered, (std::vector<char>{0, 0, 1}));
  EXPECT_DOUBLE_EQ(d.marks[0].x, 3297.06);  // the first pixel's corner is half a pixel off its centre
  EXPECT_DOUBLE_EQ(d.marks[1].y, 0.5);
  EXPECT_NEAR(d.cameras[0].fx, 13991.05582, 1e-5);  // as the format's own documentation states it for these numbers
  EXPECT_DOUBLE_EQ(d.cameras[0].cx, 4684.255692);
  EXPECT_DOUBLE_EQ(d.cameras[0].p2, 0.1);
  // It looks down, its x axis to the west: north is down on the image.
  EXPECT_NEAR(d.poses[0].camera_R_frame(2, 2), 1.0, 1e-3);
  EXPECT_NEAR(d.poses[0].camera_R_frame(0, 0), -1.0, 1e-3);
  EXPECT_NEAR(d.poses[0].camera_R_frame(1, 1), -1.0, 1e-3);
  f.file =
      write("bad.xml", std::string(blocks_head) + photo +
                           "<TiePoints><TiePoint><Measurement><PhotoId>9</PhotoId><x>0</x><y>0</y></Measurement></TiePoint></TiePoints>"
                           "</Block></BlocksExchange>");
  EXPECT_NE(fault_of(f).find("photo 9, which is not there"), std::string::npos) << fault_of(f);
  f.file = write("not.xml", "<a></a>");
  EXPECT_NE(fault_of(f).find("BlocksExchange"), std::string::npos);
  // What the parser says goes into the message, and nowhere else.
  f.file = write("cut.xml", "<BlocksExchange><Block>");
  ::testing::internal::CaptureStderr();
  const std::string cut = fault_of(f), printed = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(cut.find("not an XML file with <BlocksExchange>: "), std::string::npos) << cut;
  EXPECT_EQ(printed, "");
}

TEST_F(ImageFiles, APhotogroupWithoutPixelsIsRefused) {
  ImageFile f;
  f.format = ImageFormat::blocks_exchange;
  for (const char* width : {"0", "1e12", "9420.5"}) {
    std::string head = blocks_head;
    head.replace(head.find("9420"), 4, width);
    f.file = write("block.xml", head + "</Photogroup></Photogroups></Block></BlocksExchange>");
    EXPECT_NE(fault_of(f).find("<ImageDimensions.Width> of UCX is not a number of pixels"), std::string::npos) << fault_of(f);
  }
}

TEST_F(ImageFiles, PhotosOfOneNameInTwoFoldersAreRefused) {
  const auto photo = [](const char* id, const char* path) {
    return "<Photo><Id>" + std::string(id) + "</Id><ImagePath>" + path + "</ImagePath></Photo>";
  };
  ImageFile f;
  f.format = ImageFormat::blocks_exchange;
  f.file = write("block.xml", blocks_head + photo("1", "100MEDIA/DJI_0001.JPG") + photo("2", "101MEDIA/DJI_0001.JPG") +
                                  "</Photogroup></Photogroups></Block></BlocksExchange>");
  EXPECT_NE(fault_of(f).find("two photos have the name DJI_0001.JPG"), std::string::npos) << fault_of(f);
}

TEST_F(ImageFiles, AllFilesOfAFormatAreNamed) {
  using Names = std::vector<std::filesystem::path>;
  ImageFile f;
  f.file = "a/points.csv";
  EXPECT_EQ(files_of(f), (Names{"a/points.csv"}));
  f.format = ImageFormat::colmap, f.file = "sparse/0";
  EXPECT_EQ(files_of(f), (Names{"sparse/0/cameras.txt", "sparse/0/images.txt"}));
  f.format = ImageFormat::opensfm, f.file = "b/tracks.csv";
  EXPECT_EQ(files_of(f), (Names{"b/tracks.csv", "b/reconstruction.json"}));
}

}  // namespace
}  // namespace swath::io
