// SPDX-License-Identifier: BSD-3-Clause
// Small files, each with one thing that once was passed over, or misread.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "meshes/readers.h"
#include "meshes/text.h"

namespace readers_test {

using namespace fcl_artic::meshes;
using Eigen::Vector3d;

std::vector<std::string> notes;

using Reader = std::function<TriangleSoup(const Source&)>;

TriangleSoup read(const Reader& reader, const std::string& content) {
  notes.clear();
  const Source source{"file", content, "file", &notes};
  TriangleSoup soup = reader(source);
  soup.noteSkipped(source);
  return soup;
}

/// The error of a file that must be refused.
std::string errorOf(const Reader& reader, const std::string& content) {
  try {
    return std::to_string(read(reader, content).triangles.size()) + " triangles are read";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

// The nearest double of a decimal number that is too small for any other is 0; one that is too large is refused.
TEST(NumbersOfFiles, AreDecimalAndNearest) {
  const auto number = [](const char* word) {
    double value = 77;
    return toNumber(word, value) ? value : std::numeric_limits<double>::quiet_NaN();
  };
  EXPECT_EQ(number("1e-400"), 0);
  EXPECT_TRUE(std::signbit(number("-1e-400")));
  EXPECT_EQ(number("0.00000000000000000000000000000000001e-330"), 0);
  EXPECT_EQ(number("100000000000000000000e-419"), 0);
  EXPECT_EQ(number("4.9e-324"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(number("451237.038"), 451237.038);
  EXPECT_EQ(number("+.5"), 0.5);
  EXPECT_EQ(number("-5."), -5);
  EXPECT_EQ(number("1E+2"), 100);
  for (const char* wrong : {"1e400", "-1e400", "100000e999999999999999999999", "", "+", "-", ".", "+-1", "-+1", "0x3",
                            "1e", "1e+", "1.2.3", "1,5", "nan", "inf", "1d3", "1 "}) {
    EXPECT_TRUE(std::isnan(number(wrong))) << wrong;
  }
}

// ---- STL

const std::string kFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 451237.038 5411234.492 312.537\nvertex 0 1 "
    "0\nendloop\nendfacet\n";

TEST(StlText, KeepsDecimals) {
  const TriangleSoup soup = read(readStl, "solid\n" + kFacet + "endsolid\n");
  ASSERT_EQ(soup.triangles.size(), 1u);
  EXPECT_EQ(soup.vertices[1], Vector3d(451237.038, 5411234.492, 312.537));
}

TEST(StlBinary, AUnitOfItsHeadIsNoted) {
  std::string content = "UNITS=mm";
  content.resize(80, '\0');
  content += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  read(readStl, content);
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "'UNITS=mm': lengths are taken for metres");
}

TEST(StlText, ThatIsBinaryTooIsRefused) {
  std::string text = "solid" + std::string(75, ' ') + std::string("\4\0\0\0", 4) + "\n" + kFacet + "endsolid\n";
  text.resize(84 + 50 * 4, ' ');
  expectContains(errorOf(readStl, text), "as text and as binary");
  EXPECT_EQ(read(readStl, text + " ").triangles.size(), 1u);
}

TEST(StlText, OfSeveralSolidsIsReadOrRefused) {
  const auto count = [](const std::string& content) { return read(readStl, content).triangles.size(); };
  EXPECT_EQ(count("solid part endsolidworks\n" + kFacet + kFacet + "endsolid part endsolidworks\n"), 2u);
  EXPECT_EQ(count("solid a\n" + kFacet + "endsolid a\nsolid b\n" + kFacet + "endsolid\nSOLID\nENDSOLID\n"), 2u);
  expectContains(errorOf(readStl, "solid a\n" + kFacet + "endsolid a\n" + kFacet), "outside of its solids");
  expectContains(errorOf(readStl, "solid a\n" + kFacet + "endsolid a solid b\n" + kFacet + "endsolid b\n"),
                 "'solid' within the name");
  expectContains(errorOf(readStl, "solid a " + kFacet + kFacet + "endsolid a\n"), "within the name");
  expectContains(errorOf(readStl, "solid a\n" + kFacet + "solid b\n" + kFacet + "endsolid\n"),
                 "a solid within a solid");
  expectContains(errorOf(readStl, "solid a\n" + kFacet + "endsolid\nendsolid\n"), "after no solid");
  expectContains(errorOf(readStl, "solid a\n" + kFacet), "no 'endsolid'");
  expectContains(errorOf(readStl, "solid a\n" + kFacet + "hull 1\nendsolid\n"), "between facets, at 'hull'");
  expectContains(errorOf(readStl,
                         "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 vertex 1 1 0 "
                         "endloop endfacet endsolid\n"),
                 "within a facet");
  expectContains(errorOf(readStl,
                         "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1e999 0 0 vertex 0 1 0 endloop "
                         "endfacet endsolid\n"),
                 "'1e999' of a vertex");
}

// ---- OBJ

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 2 0\n";

TEST(Obj, MarksLineEndsAndWordsThatWouldShiftVertices) {
  const auto isRead = [](const std::string& content) {
    const TriangleSoup soup = read(readObj, content);
    return soup.triangles.size() == 1 && soup.vertices[soup.triangles[0][1]] == Vector3d(1, 0, 0);
  };
  EXPECT_TRUE(isRead("\xEF\xBB\xBF" + kObj + "f 1 2 3\n"));
  EXPECT_TRUE(isRead("v 0 0 0\rv 1 0 0\nv 0 2 0\r\nf 1 2 3\r"));
  EXPECT_TRUE(isRead(kObj + "fo 1 2 3\n"));
  EXPECT_TRUE(isRead("3 1\n" + kObj + "f 1 2 3\n"));
  expectContains(errorOf(readObj, "4 1\n" + kObj + "f 1 2 3\n"), "its first line says 4 vertices");
  expectContains(errorOf(readObj, "\xFF\xFEv"), "UTF-16");
  expectContains(errorOf(readObj, "v 0 0 0 v 1 0 0\n"), "'v' is not a finite number");
  expectContains(errorOf(readObj, "v 0 0 0 1 2\n"), "five numbers");
  expectContains(errorOf(readObj, "v 0 0 0 .1 .2 .3 .4\n"), "fourth number that is not 1");
  expectContains(errorOf(readObj, "v 0 0 0 1 .2 .3 .4 5\n"), "goes on after");
  expectContains(errorOf(readObj, "v 2 0 0 2\n"), "fourth number that is not 1");
  expectContains(errorOf(readObj, kObj + "call more.obj\nf 1 2 3\n"), "'call' refers to another file");
  expectContains(errorOf(readObj, kObj + "surf 0 1 0 1 1 2 3\nf 1 2 3\n"), "free-form");
  expectContains(errorOf(readObj, kObj + "face 1 2 3\nf 1 2 3\n"), "'face' begins a line of no kind");
  expectContains(errorOf(readObj, kObj + "f 1 2 3 x/1\n"), "'x/1' names no vertex");
}

// If a name ends in a backslash, some readers take the next line, a face or a vertex, for a part of it.
TEST(Obj, LinesThatMayTakeInTheNextOneAreRefused) {
  for (const char* line : {"g part\\\n", "usemtl C:\\mat\\ \n", "o a \\\n", "vn 0 0 \\\n"}) {
    expectContains(errorOf(readObj, kObj + line + "f 1 2 3\nf 1 2 3\n"), ": a line of '");
  }
  expectContains(errorOf(readObj, kObj + "l 1 2\\\nf 1 2 3\nf 1 2 3\n"), "'f' names no vertex");
  read(readObj, kObj + "l 1 \\\n 2/1\nf 1 2 3\n");
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "its lines, 1,");
  EXPECT_EQ(read(readObj, "# c:\\\n" + kObj + "f 1\\\n 2 3\n").triangles.size(), 1u);
}

TEST(Obj, PointsLinesAndFacesThatAreNotFlatAreNoted) {
  read(readObj, kObj + "v 1 1 0.3\nf 1 2 4 3\np 1\nl 1 2\nf 1 2\nf 3\n");
  ASSERT_EQ(notes.size(), 3u);
  expectContains(notes[0], "its points, 2, have no surface");
  expectContains(notes[1], "its lines, 2, have no surface");
  expectContains(notes[2], "1 face is not flat");
  // Six digits are not enough for flat ones far away.
  read(readObj,
       "v 451237 100.333 1\nv 451238 100.333 1.33333\nv 451238 101.333 1.66667\nv 451237 101.333 1.33334\nf 1 2 3 4\n");
  EXPECT_TRUE(notes.empty());
}

// The time for a polygon that crosses itself would grow with the cube of its corners.
TEST(Obj, FacesThatTakeTooLongToCutAreRefused) {
  std::string star;
  constexpr int kCorners = 4001;
  for (int i = 0; i < kCorners; ++i) {
    const double turn = 2 * 3.14159265358979323846 * i / kCorners;
    star += "v " + std::to_string((1 + i * 7919 % 997) * std::cos(turn)) + " " +
            std::to_string((1 + i * 104729 % 991) * std::sin(turn)) + " 0\n";
  }
  star += "f";
  for (int i = 1; i <= kCorners; ++i) star += " " + std::to_string(i);
  expectContains(errorOf(readObj, star + "\n"), "a face of 4001 corners that takes too long to cut");
}

// ---- OFF

TEST(Off, CountsAndWhatFollowsThem) {
  const std::string vertices = "0 0 0\n1 0 0\n0 2 451237.038\n";
  const TriangleSoup soup = read(readOff, "OFF 3 1 0\n" + vertices + "3 0 1 2\n");
  EXPECT_EQ(soup.vertices[2], Vector3d(0, 2, 451237.038));
  expectContains(errorOf(readOff, "OFF 3 1 0\n" + vertices + "3 0 1 2\n3 0 2 1\n"), "goes on after its last face");
  expectContains(errorOf(readOff, "OFF 3 1 0\n" + vertices + "3 0 1 3\n"), "vertex 3 of 3");
  expectContains(errorOf(readOff, "OFF 3 1 0\n" + vertices + "3 0 1 1.5\n"), "'1.5' is no number of a vertex");
  expectContains(errorOf(readOff, "OFF 3 1 0\n" + vertices + "3 0 1 2 0 1\n"), "not with a colour");
  expectContains(errorOf(readOff, "4OFF 3 1 0\n" + vertices + "3 0 1 2\n"), "begins with '4OFF'");
  expectContains(errorOf(readOff, "OFF BINARY\n"), "binary OFF");
  expectContains(errorOf(readOff, "OFF 3 1 0\n0 0 0 1 0 0\n0 2 0\n3 0 1 2\n"), "a vertex has 6 numbers");
}

// ---- PLY

std::string ply(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" + elements +
         "end_header\n0 0 0\n1 0 0\n0 451237.038 0\n" + body;
}
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";

TEST(Ply, ElementsThatMayBeGeometryAreReadOrRefused) {
  EXPECT_EQ(read(readPly, ply(kFaces, "3 0 1 2\n")).vertices[2], Vector3d(0, 451237.038, 0));
  const auto error = [](const std::string& elements, const std::string& body) {
    return errorOf(readPly, ply(elements, body));
  };
  expectContains(error(kFaces + kFaces, "3 0 1 2\n3 0 1 2\n"), "two elements 'face'");
  expectContains(error("element polygon 1\nproperty list uchar int vertex_indices\n", "3 0 1 2\n"), "no triangles");
  expectContains(error(kFaces + "element polygon 1\nproperty int a\n", "3 0 1 2\n1\n"),
                 "element 'polygon', which is not read");
  expectContains(error(kFaces, "3 0 1 2\n3 0 1 2\n"), "goes on after its last element");
  expectContains(error(kFaces, "3 0 1 1.5\n"), "has a face with vertex 1 of 3");
  expectContains(error(kFaces, "3 0 1 -1\n"), "vertex -1 of 3");
  expectContains(error(kFaces, "3 0 1\n"), "isn't there or has other entries");
  expectContains(error(kFaces, "3 0 1 2 2\n"), "isn't there or has other entries");
  expectContains(error("element face 1\nproperty list uchar int vertices\n", "3 0 1 2\n"),
                 "has a list 'vertices', which is not read");
  expectContains(error("element face 1\nproperty list uchar int vertex_index\nproperty list uchar int vertex_indices\n",
                       "3 0 1 2 3 0 1 2\n"),
                 "two lists of vertices");
  expectContains(error("property float radius\n" + kFaces, "3 0 1 2\n"), "an extent ('radius')");
  const std::string cloud = ply("element polygon 1\nproperty list uchar int vertex_indices\n", "3 0 1 2\n");
  const Source source{"file", cloud, "file", nullptr};
  EXPECT_THROW(readPlyPoints(source), std::runtime_error);
  read(readPly,
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
       "warmth\n" +
           kFaces +
           "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 "
           "2\n0 1\n");
  ASSERT_EQ(notes.size(), 2u);
  expectContains(notes[0], "passed over of each vertex: 'warmth'");
  expectContains(notes[1], "its lines, 1,");
}

// The last number of a text that is cut short is another one.
TEST(TextFiles, WithoutALastLineEndAreNoted) {
  const std::string off = "OFF 12 1 0\n" + [] {
    std::string vertices;
    for (int k = 0; k < 12; ++k) vertices += std::to_string(k) + " " + std::to_string(k * k) + " 1\n";
    return vertices;
  }() + "3 0 1 1";
  const std::string head = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n";
  const auto ofCloud = [](Points (*reader)(const Source&)) {
    return [reader](const Source& source) {
      reader(source);
      return TriangleSoup();
    };
  };
  for (const auto& [reader, content] : {std::pair<Reader, std::string>{readObj, kObj + "f 1 2 3"},
                                        {readOff, off},
                                        {readPly, ply(kFaces, "3 0 1 2")},
                                        {ofCloud(readXyz), "0 0 1.2"},
                                        {ofCloud(readPcd), head + "0 0 1.2"}}) {
    read(reader, content);
    ASSERT_EQ(notes.size(), 1u) << content;
    expectContains(notes[0], "has no line end: the file may be cut short");
    read(reader, content + "\r");
    EXPECT_TRUE(notes.empty()) << content;
  }
}

TEST(TextFiles, UnitsAndShiftsOfACommentAreNoted) {
  const auto notesOf = [](const std::string& content) {
    notes.clear();
    noteComments({"file", content, "file", &notes});
    return notes.size();
  };
  EXPECT_EQ(notesOf("v 0 0 0\n  # File units = centimeters\n"), 1u);
  expectContains(notes.at(0), "'  # File units = centimeters': lengths are taken for metres");
  EXPECT_EQ(notesOf("ply\r\ncomment Unit: mm\r\n"), 1u);
  EXPECT_EQ(notesOf("solid part UNITS=mm\n"), 1u);
  EXPECT_EQ(notesOf("# Units: meters\n# made at the unit of robots\n"), 1u) << "the second one";
  EXPECT_EQ(notesOf("# Units: m\nusemtl unit\n# untied\n"), 0u);
  EXPECT_EQ(notesOf("# all lengths in mm\n# from millimetres to metres\n# 3 inches of snow\n"), 2u) << "1st and 3rd";
  EXPECT_EQ(notesOf("ply\ncomment offset 451000 5411000 -3.5\n"), 1u);
  expectContains(notes.at(0), "which is not applied");
  EXPECT_EQ(notesOf("# origin 0 0 0\n# shift left\n# offset: 1 2\n# 1 2 3\n"), 0u);
}

// ---- COLLADA

/// @param more  into the mesh. @param node  of the scene. @param libraries  beside the geometry.
std::string collada(const std::string& more, const std::string& node, const std::string& libraries = "") {
  return "<COLLADA><asset><unit meter=\"0.5\"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry "
         "id=\"g\"><mesh>"
         "<source id=\"p\"><float_array id=\"a\" count=\"9\">0 0 0 451237.038 0 0 0 2 0</float_array><technique_common>"
         "<accessor source=\"#a\" count=\"3\" stride=\"3\"><param name=\"X\"/><param name=\"Y\"/><param "
         "name=\"Z\"/></accessor>"
         "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>" +
         more + "</mesh></geometry></library_geometries>" + libraries +
         "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">" + node +
         "</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}
const std::string kInput = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
const std::string kTriangles = "<triangles count=\"1\">" + kInput + "<p>0 1 2</p></triangles>";
const std::string kHere = "<instance_geometry url=\"#g\"/>";
TriangleSoup readDae(const Source& source) {
  return readCollada(source, false);
}

TEST(ColladaFile, KeepsDecimalsAndPlaces) {
  const TriangleSoup soup = read(readDae, collada(kTriangles, "<translate>5411234.492 0 1</translate>" + kHere));
  EXPECT_EQ(soup.vertices[1], Vector3d(0.5 * (451237.038 + 5411234.492), 0, 0.5));
  EXPECT_TRUE(notes.empty());
}

TEST(ColladaFile, WhatIsNotReadIsRefused) {
  const auto error = [](const std::string& more, const std::string& node, const std::string& libraries = "") {
    return errorOf(readDae, collada(more, node, libraries));
  };
  expectContains(error(kTriangles, "<skew>30 0 1 0 1 0 0</skew>" + kHere), "<skew> is not read");
  EXPECT_EQ(
      read(readDae, collada(kTriangles, kHere + "<node><lookat>1 2 3 4 5 6 7 8 9</lookat></node>")).triangles.size(),
      1u);
  expectContains(error(kTriangles, "<instance_controller url=\"#c\"/>" + kHere), "bends a mesh");
  expectContains(error(kTriangles, kHere, "<library_animations><animation><channel/></animation></library_animations>"),
                 "without animations");
  const std::string other = collada(kTriangles, "<translate>9 0 0</translate>" + kHere);
  expectContains(errorOf(readDae, collada(kTriangles, kHere) + other), "<COLLADA> is a second root element");
  expectContains(errorOf(readDae, collada(kTriangles, kHere) + std::string(1, '\0') + other), "byte 0");
  std::string unit = collada(kTriangles, kHere);
  unit.replace(unit.find("meter=\"0.5\""), 11, "name=\"inch\"");
  expectContains(errorOf(readDae, unit), "<unit> is called 'inch', and does not say how many metres");
  expectContains(error(kTriangles + "<trianglos/>", kHere), "<trianglos> is not read");
  expectContains(error(kTriangles, kHere + "<instance_geometri url=\"#g\"/>"), "<instance_geometri> is not read");
  expectContains(error("<triangles>" + kInput + "<p>0 1 2</p></triangles>", kHere), "has no count");
  expectContains(error("<triangles count=\"2\">" + kInput + "<p>0 1 2</p></triangles>", kHere), "needs 6 corners");
  expectContains(error("<triangles count=\"1\">" + kInput + "<p>0 1 2.5</p></triangles>", kHere),
                 "'2.5' in place of a whole number");
  expectContains(error("<triangles count=\"1\">" + kInput + "<p>0 1 3</p></triangles>", kHere), "vertex 3 of 3");
  expectContains(error("<triangles count=\"1\">" + kInput + "<p>0 1 -1</p></triangles>", kHere), "'-1' in place of");
  expectContains(error("<polygons count=\"1\">" + kInput + "<ph><p>0 1 2</p><h>0</h></ph></polygons>", kHere), "holes");
  expectContains(error(kTriangles, "<instance_geometry url=\"#h\"/>"), "which isn't there");
  expectContains(error(kTriangles, "<instance_geometry url=\"other.dae#g\"/>"), "another file");
  expectContains(error(kTriangles, kHere + "<instance_node url=\"#n\"/>"), "in a circle");
  std::string convex = collada(kTriangles, kHere);
  convex.replace(convex.find("<mesh>"), 6, "<convex_mesh>");
  convex.replace(convex.find("</mesh>"), 7, "</convex_mesh>");
  expectContains(errorOf(readDae, convex), "<convex_mesh> is not read");
  std::string short_array = collada(kTriangles, kHere);
  short_array.replace(short_array.find("451237.038 "), 11, "");
  expectContains(errorOf(readDae, short_array), "says that it has 9 numbers, it has 8");
}

TEST(ColladaFile, UnitsWithinAreThatOfTheFile) {
  const std::string other = "<asset><unit meter=\"0.001\"/></asset>", same = "<asset><unit meter=\"0.5\"/></asset>";
  const auto with = [](const std::string& asset, const std::string& after) {
    std::string text = collada(kTriangles, kHere, "<library_nodes></library_nodes>");
    return text.insert(text.find(after) + after.size(), asset);
  };
  for (const char* after :
       {"<library_geometries>", "<library_nodes>", "<library_visual_scenes>", "<source id=\"p\">"}) {
    expectContains(errorOf(readDae, with(other, after)), "has another unit");
    EXPECT_EQ(read(readDae, with(same, after)).triangles.size(), 1u) << after;
  }
  std::string two = collada(kTriangles, kHere);
  const std::size_t common = two.find("<technique_common>"), end = two.find("</source>");
  two.insert(end, two.substr(common, end - common));
  expectContains(errorOf(readDae, two), "more than one <technique_common>");
}

// Nodes that show nodes that show nodes: of 3 kB, 10^8 triangles.
TEST(ColladaFile, InstancesOfInstancesAreBounded) {
  const auto nodes = [](int levels, const std::string& leaf) {
    std::string library = "<library_nodes><node id=\"n0\">" + leaf + "</node>";
    for (int k = 1; k <= levels; ++k) {
      library += "<node id=\"n" + std::to_string(k) + "\">";
      for (int copies = 0; copies < 10; ++copies) library += "<instance_node url=\"#n" + std::to_string(k - 1) + "\"/>";
      library += "</node>";
    }
    return library + "</library_nodes>";
  };
  const auto show = [](int level) { return "<instance_node url=\"#n" + std::to_string(level) + "\"/>"; };
  EXPECT_EQ(read(readDae, collada(kTriangles, show(3), nodes(3, kHere))).triangles.size(), 1000u);
  expectContains(errorOf(readDae, collada(kTriangles, show(8), nodes(8, kHere))), "unfolds to too much: it is of ");
  expectContains(errorOf(readDae, collada(kTriangles, kHere + show(8), nodes(8, ""))), "unfolds to too much");
}

TEST(ColladaFile, GeometryThatTheSceneDoesNotShowIsNoted) {
  read(readDae,
       collada(kTriangles, kHere, "<library_geometries><geometry id=\"h\"><mesh/></geometry></library_geometries>"));
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "1 geometry element of 2 left out");
}

// ---- glTF

#ifdef FCL_ARTIC_GLTF

/// One triangle (0,0,0) (1,0,0) (0,2,0). @param node, mesh, primitive, root  more of each.
std::string gltf(const std::string& node, const std::string& primitive = "", const std::string& root = "",
                 const std::string& mesh = "") {
  return "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0" + node +
         "}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}" + primitive + "}]" + mesh +
         "}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":"
         "[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"data:;base64,"
         "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAA\"}]" +
         root + "}";
}
TriangleSoup readAsItStands(const Source& source) {
  return readGltf(source, false);
}

TEST(GltfFile, IsUpInYAndKeepsPlaces) {
  const std::string content = gltf(",\"translation\":[451237.038,5411234.492,0]");
  const TriangleSoup soup = read(readAsItStands, content);
  ASSERT_EQ(soup.triangles.size(), 1u);
  EXPECT_EQ(soup.vertices[2], Vector3d(451237.038, 5411236.492, 0));
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "by the rules of its format y is up: taken as it stands");
  const TriangleSoup turned = read([](const Source& source) { return readGltf(source, true); }, content);
  EXPECT_EQ(turned.vertices[2], Vector3d(451237.038, 0, 5411236.492));
  expectContains(notes[0], "turned so that z is");
}

TEST(GltfFile, WhatIsNotReadIsRefused) {
  const auto error = [](const std::string& content) { return errorOf(readAsItStands, content); };
  expectContains(error(gltf("", "", ",\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"]")),
                 "needs the extension 'EXT_mesh_gpu_instancing'");
  EXPECT_EQ(read(readAsItStands, gltf("", "", ",\"extensionsRequired\":[\"KHR_materials_unlit\"]")).triangles.size(),
            1u);
  expectContains(error(gltf(",\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}")), "node 0 has the extension");
  expectContains(error(gltf("", ",\"extensions\":{\"KHR_draco_mesh_compression\":{}}")),
                 "primitive 0 has the extension");
  expectContains(error(gltf(",\"skin\":0")), "by bones");
  expectContains(error(gltf(",\"weights\":[1]")), "weights of morph targets");
  expectContains(error(gltf("", "", "", ",\"weights\":[1]")), "weights of morph targets");
  expectContains(error(gltf("", ",\"targets\":[{}]")), "morph targets");
  expectContains(error(gltf("", "", ",\"animations\":[{}]")), "animations");
  expectContains(error(gltf("", ",\"mode\":7")), "unknown mode 7");
  expectContains(error(gltf(",\"translations\":[0,0,1]")), "'translations', which is not read");
  expectContains(error(gltf(",\"scale\":[1,1]")), "no list of 3 numbers");
  expectContains(error(gltf(",\"rotation\":[0,0,0,0.5]")), "no quaternion of length 1");
  expectContains(error(gltf(",\"children\":[0]")), "below");
  expectContains(error(gltf(",\"mesh\":0")), "the key 'mesh' is there twice in one object");
  expectContains(error(gltf("") + std::string("\0{}", 3)), "byte 0");
  EXPECT_EQ(read(readAsItStands, gltf("") + std::string(3, '\0')).triangles.size(), 1u) << "as some writers pad it";
  expectContains(error(gltf("", ",\"indices\":0")), "not of type SCALAR");
  std::string content = gltf("");
  content.replace(content.find("\"count\":3"), 9, "\"count\":4");
  expectContains(error(content), "beyond its bufferView");
  expectContains(error(std::string(200000, '[')), "no glTF");
  content = gltf("");
  content.replace(content.find("\"2.0\""), 5, "\"2.1\",\"minVersion\":\"2.1\"");
  expectContains(error(content), "needs glTF of version '\"2.1\"'");
  content = gltf("");
  content.replace(content.find("\"2.0\""), 5, "\"2.0\",\"unit\":\"mm\"");
  expectContains(error(content), "asset has 'unit', which is not read");
}

// Primitives that share their numbers.
TEST(GltfFile, WhatIsThereRepeatedlyIsBounded) {
  std::string content = gltf("");
  const std::string one = "{\"attributes\":{\"POSITION\":0}}", many = [&] {
    std::string all = "{\"attributes\":{\"POSITION\":0}}";
    for (int k = 0; k < 200; ++k) all += ",{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":5}";
    return all;
  }();
  content.replace(content.find(one), one.size(), many);
  const std::string indices = "\"type\":\"VEC3\"}";
  content.replace(content.find(indices), indices.size(),
                  indices + ",{\"bufferView\":1,\"componentType\":5121,\"count\":30000,\"type\":\"SCALAR\"}");
  content.replace(content.find("\"bufferViews\":["), 15, "\"bufferViews\":[");
  const std::string view = "\"byteLength\":36}],\"buffers\":[";
  content.replace(content.find(view), view.size(),
                  "\"byteLength\":36},{\"buffer\":1,\"byteLength\":30000}],\"buffers\":[");
  const std::string end = "AAAAAAAAAAAAAEAAAAAA\"}]";
  content.replace(content.find(end), end.size(),
                  end.substr(0, end.size() - 1) + ",{\"byteLength\":30000,\"uri\":\"data:;base64," +
                      std::string(40000, 'A') + "\"}]");
  expectContains(errorOf(readAsItStands, content), "unfolds to too much");
}

#endif

// ---- points

Points cloudOf(const std::function<Points(const Source&)>& reader, const std::string& content) {
  notes.clear();
  return reader({"file", content, "file", &notes});
}
std::string cloudError(const std::function<Points(const Source&)>& reader, const std::string& content) {
  try {
    return std::to_string(cloudOf(reader, content).size()) + " points are read";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(Xyz, HasOneSeparatorAndOneNumberOfColumns) {
  const Points points = cloudOf(readXyz, "1 2 3\n1e-400 0 0\n");
  EXPECT_EQ(points[1], Vector3d(0, 0, 0)) << "and not the point before";
  expectContains(cloudError(readXyz, "1 2 3\n1e400 0 0\n"), "'1e400'");
  for (const char* commas : {"0,5 0,0 0,0\n", "0,5;0,0;0,0\n", "0,5\t0,0\t0,0\n"}) {
    expectContains(cloudError(readXyz, commas), "decimals need a point");
  }
  EXPECT_EQ(cloudOf(readXyz, "1, 2, 3, 9\n4,5,6,7\n").size(), 2u);
  expectContains(cloudError(readXyz, "1 2 3\n1,2,3\n"), "line 2");
  expectContains(cloudError(readXyz, "1 2 3\n1 2 3 4\n"), "4 columns, the first line has 3");
  expectContains(cloudError(readXyz, "1 2\n"), "three numbers");
  cloudOf(readXyz, "1 2 3 0.5\n");
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "of each point the first 3 numbers are read, of 4");
}

/// Some C libraries print 1.#INF and -1.#IND for what is no number: not 1 and -1 with a comment.
TEST(TextFiles, ASignOfACommentWithinAWordBeginsNone) {
  EXPECT_EQ(read(readObj, "v 0 0 0 # here\n#v\nv 1 0 0 #\nv 0 1 1\nusemtl a#b\nf 1 2 3\t#\n").triangles.size(), 1u);
  for (const std::string word : {"1.#INF", "-1.#IND", "1.#QNAN", "1#note"}) {
    expectContains(errorOf(readObj, "v 0 0 0\nv 1 0 0\nv 0 1 " + word + "\nf 1 2 3\n"),
                   "line 3: '" + word + "' is not a finite number");
    expectContains(errorOf(readOff, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 " + word + "\n3 0 1 2\n"),
                   "line 5: '" + word + "' is not a finite number");
    expectContains(cloudError(readXyz, "0 0 0\n0 1 " + word + "\n"),
                   "line 2: does not begin with three numbers between blanks: '" + word + "'");
    expectContains(
        cloudError(readPcd, "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n0 1 " + word + "\n"),
        "point 0 is not as FIELDS says");
  }
  expectContains(errorOf(readObj, "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3#\n"), "'3#' names no vertex");
}

TEST(PlyPoints, FacesAndEdgesAreNoted) {
  cloudOf(readPlyPoints,
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nelement edge 2\nproperty int vertex1\n"
          "property int vertex2\nend_header\n0 0 0\n1 0\n0 0\n0 0\n");
  ASSERT_EQ(notes.size(), 2u);
  expectContains(notes[0], "its faces, 1, are left out");
  expectContains(notes[1], "its edges, 2, are left out");
}

TEST(PlyPoints, ACameraThatIsElsewhereIsNoted) {
  const auto notesOf = [](const std::string& view) {
    cloudOf(readPlyPoints,
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            "element camera 1\nproperty float view_px\nproperty float x_axisx\nproperty float x_axisy\nproperty float "
            "focal\nend_header\n1 2 3\n" +
                view + " 0\n");
    return notes.size();
  };
  EXPECT_EQ(notesOf("0 1 0"), 0u);
  EXPECT_EQ(notesOf("5 1 0"), 1u);
  EXPECT_EQ(notesOf("0 0 1"), 1u);
  expectContains(notes.at(0), "its camera is elsewhere than at the origin");
}

std::string pcd(const std::string& more, const std::string& body,
                const std::string& counts = "WIDTH 2\nHEIGHT 1\nPOINTS 2\n") {
  return "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n" + counts + more + "DATA ascii\n" + body;
}

TEST(PcdFile, CountsAgreeAndNothingIsLeftOver) {
  EXPECT_EQ(cloudOf(readPcd, pcd("", "1 2 3\n1e-400 0 0\n"))[1], Vector3d(0, 0, 0));
  expectContains(cloudError(readPcd, pcd("", "1 2 3\n4 5 6\n7 8 9\n")), "goes on after its last point");
  expectContains(cloudError(readPcd, pcd("", "1 2 3\n4 5 6\n", "WIDTH 1\nHEIGHT 1\nPOINTS 2\n")),
                 "are not WIDTH times HEIGHT");
  expectContains(cloudError(readPcd, pcd("", "1 2 3\n4 5 6\n", "WIDTH 3\nHEIGHT 1\nPOINTS 2\n")),
                 "are not WIDTH times HEIGHT");
  expectContains(cloudError(readPcd, pcd("POINTS 1\n", "1 2 3\n4 5 6\n")), "two lines 'POINTS'");
  const std::string head = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA binary\n";
  EXPECT_EQ(cloudOf(readPcd, head + std::string(12, '\0') + std::string(100, '\0')).size(), 1u)
      << "zeros up to a page's end";
  expectContains(cloudError(readPcd, head + std::string(24, '\1')), "goes on after its last point");
}

TEST(PcdFile, FieldsThatNobodyKnowsAreNoted) {
  const auto text = [](const std::string& field, const std::string& version) {
    return "VERSION " + version + "\nFIELDS x y z " + field +
           "\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS 1\nDATA ascii\n1 2 3 4\n";
  };
  cloudOf(readPcd, text("intensity", "0.7"));
  EXPECT_TRUE(notes.empty());
  cloudOf(readPcd, text("dx", ".7"));
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "passed over of each point: 'dx'");
  expectContains(cloudError(readPcd, text("diameter", ".7")), "have an extent ('diameter')");
  expectContains(cloudError(readPcd, text("intensity", ".8")), "a VERSION other than");
}

TEST(PcdFile, AViewpointThatIsNoneIsNoted) {
  for (const char* none : {"0 0 0 1 0 0 0", "0.0 0.0 0 1.0 0 0 0", "0 0 0 -1 0 0 0", "-0 0e3 0 1 0 0 0"}) {
    cloudOf(readPcd, pcd("VIEWPOINT " + std::string(none) + "\n", "1 2 3\n4 5 6\n"));
    EXPECT_TRUE(notes.empty()) << none;
  }
  for (const char* other : {"10 0 0 1 0 0 0", "0 0 0 1 0 0 0.1", "10 0 0 0 1 0 0 0", "0 0 0.5 1 0 0 0"}) {
    cloudOf(readPcd, pcd("VIEWPOINT " + std::string(other) + "\n", "1 2 3\n4 5 6\n"));
    EXPECT_EQ(notes.size(), 1u) << other;
  }
}

}  // namespace readers_test
