// Drawings as PDF: the structure of the file, and what its page draws.

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "sightline/drawing/drawing.h"
#include "src/drawing/pdf_file.h"
#include "tests/drawing/made_drawings.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using test::drawingOf;
using test::object;

// The objects of a file by number, found through its table; failures of structure fail the test.
std::map<int, std::string> objectsOf(const std::string& pdf) {
  std::map<int, std::string> objects;
  EXPECT_EQ(pdf.rfind("%PDF-1.5\n", 0), 0u);
  EXPECT_EQ(pdf.substr(pdf.size() - 6), "%%EOF\n");
  const std::size_t start = pdf.rfind("startxref\n");
  const auto table = static_cast<std::size_t>(std::atoll(pdf.c_str() + start + 10));
  EXPECT_EQ(pdf.compare(table, 7, "xref\n0 "), 0);
  const int count = std::atoi(pdf.c_str() + table + 7);
  std::size_t line = pdf.find('\n', table + 7) + 1;
  EXPECT_EQ(pdf.substr(line, 20), "0000000000 65535 f \n");
  for (int number = 1; number < count; ++number) {
    line += 20;
    const std::string entry = pdf.substr(line, 20);
    EXPECT_TRUE(std::regex_match(entry, std::regex("[0-9]{10} 00000 n \n"))) << entry;
    const auto offset = static_cast<std::size_t>(std::atoll(entry.c_str()));
    const std::string head = std::to_string(number) + " 0 obj\n";
    EXPECT_EQ(pdf.compare(offset, head.size(), head), 0) << "object " << number;
    const std::size_t end = pdf.find("\nendobj\n", offset);
    objects[number] = pdf.substr(offset + head.size(), end - offset - head.size());
  }
  EXPECT_EQ(pdf.compare(line + 20, 8, "trailer\n"), 0);
  EXPECT_NE(pdf.find("/Size " + std::to_string(count), line), std::string::npos);
  return objects;
}

int reference(const std::string& text, const std::string& key) {
  const std::size_t at = text.find("/" + key + " ");
  EXPECT_NE(at, std::string::npos) << key << " in " << text;
  return at == std::string::npos ? 0 : std::atoi(text.c_str() + at + key.size() + 2);
}

struct Read {
  std::map<int, std::string> objects;
  std::string catalogue, page, contents;  // the contents are inflated
};

std::string inflated(const std::string& stream) {
  const std::size_t begin = stream.find("stream\n") + 7;
  const auto length = static_cast<std::size_t>(reference(stream, "Length"));
  EXPECT_EQ(stream.substr(begin + length), "\nendstream");
  std::string out(std::size_t{1} << 20, '\0');
  uLongf size = out.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                       reinterpret_cast<const Bytef*>(stream.data() + begin), length),
            Z_OK);
  out.resize(size);
  return out;
}

Read read(const std::string& pdf) {
  Read file;
  file.objects = objectsOf(pdf);
  file.catalogue = file.objects[reference(pdf.substr(pdf.rfind("trailer")), "Root")];
  const std::string pages = file.objects[reference(file.catalogue, "Pages")];
  file.page = file.objects[std::atoi(pages.c_str() + pages.find("/Kids [") + 7)];
  file.contents = inflated(file.objects[reference(file.page, "Contents")]);
  return file;
}

// The layers and the operators that paint them, in order: "L6 f*, L6 S, ...".
std::vector<std::string> paintsOf(const Read& file) {
  std::vector<std::string> paints;
  std::istringstream lines(file.contents);
  std::string line, layer;
  while (std::getline(lines, line)) {
    if (line.rfind("/OC /", 0) == 0) {
      EXPECT_EQ(layer, "");
      layer = line.substr(5, line.find(' ', 5) - 5);
      EXPECT_EQ(line, "/OC /" + layer + " BDC");
    } else if (line == "EMC") {
      EXPECT_NE(layer, "");
      layer.clear();
    } else if (line == "f*" || line == "S") {
      const int number = reference(file.page, layer);
      const std::string& name = file.objects.at(number);
      paints.push_back(name.substr(name.find("/Name ") + 6) + " " + line);
    }
  }
  EXPECT_EQ(layer, "");
  return paints;
}

TEST(Pdf, EveryObjectIsALayerWithItsName) {
  const Read file = read(toPdf(drawingOf({{{object(0, "wall")}}, {{object(1, "door")}}})));
  EXPECT_EQ(paintsOf(file),
            (std::vector<std::string>{"(wall) >> f*", "(wall) >> S", "(door) >> f*", "(door) >> S"}));
  EXPECT_NE(file.page.find("/MediaBox [0 0 640 360]"), std::string::npos);
  // All layers are listed, once each.
  const std::string all = file.catalogue.substr(file.catalogue.find("/OCGs ["));
  for (const char* name : {"(wall)", "(door)"}) {
    for (const auto& [number, text] : file.objects) {
      if (text.find(std::string("/Name ") + name) != std::string::npos) {
        const std::string reference = " " + std::to_string(number) + " 0 R";
        EXPECT_LT(all.find(reference), all.find("]"));
        EXPECT_NE(all.find(reference, all.find("/Order [")), std::string::npos);
      }
    }
  }
}

TEST(Pdf, OutlinesOfAGroupLieBelowItsStrokes) {
  const Read file = read(toPdf(drawingOf({{{object(0, "a"), object(1, "b")}}})));
  EXPECT_EQ(paintsOf(file), (std::vector<std::string>{"(a) >> f*", "(b) >> f*", "(a) >> S", "(b) >> S"}));
  EXPECT_TRUE(
      std::regex_search(file.catalogue, std::regex("/Order \\[ \\[\\(Group 1\\) \\d+ 0 R \\d+ 0 R\\] \\]")))
      << file.catalogue;
}

TEST(Pdf, PathsAreTheDrawings) {
  DrawingObject drawn = object(1, "x");
  drawn.strokes[0] = {{10, 0}, {18, 0}, {18, 8.5}, {10, 0}};
  const Read file =
      read(toPdf(drawingOf({{{drawn}}}), {.stroke_width = 0.5, .stroke = "#ff0000", .paper = "#00ff00"}));
  EXPECT_EQ(file.contents,
            "1 0 0 -1 0 360 cm\n1 J 1 j .5 w\n1 0 0 RG 0 1 0 rg\n0 0 640 360 re f\n"
            "/OC /L6 BDC\n10 0 m\n18 0 l\n18 8 l\n10 8 l\nh\nf*\nEMC\n"
            "/OC /L6 BDC\n10 0 m\n18 0 l\n18 8.5 l\nh\n11 1 m\n13.25 2.5 l\nS\nEMC\n");
}

TEST(Pdf, NamesAreEncoded) {
  EXPECT_EQ(drawing::pdfString("plain"), "(plain)");
  EXPECT_EQ(drawing::pdfString("a(b)\\c"), "(a\\(b\\)\\\\c)");
  EXPECT_EQ(drawing::pdfString("\xc3\xa9"), "<FEFF00E9>");
  EXPECT_EQ(drawing::pdfString("\xf0\x9f\x8f\xa0"), "<FEFFD83CDFE0>");
  EXPECT_EQ(drawing::pdfString("\xff"), "<FEFFFFFD>");
  EXPECT_EQ(drawing::pdfString("a\nb"), "<FEFF0061000A0062>");
  EXPECT_EQ(drawing::pdfString(""), "()");
}

TEST(Pdf, HostileDrawingsMakeSoundFiles) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  DrawingObject drawn{.object = ObjectId(0u),
                      .name = "endobj\nstream ) >>",
                      .outline = {{{0, 0}, {1, kNan}, {1, 1}}, {}, {{1, 1}, {1, 1}}},
                      .strokes = {{}, {{1, 1}}, {{0, 0}, {kNan, 1}}}};
  const Read file = read(toPdf(drawingOf({{{drawn, DrawingObject{}}}, {}}), {.title = "(("}));
  EXPECT_TRUE(paintsOf(file).empty());
  read(toPdf({}));
  read(toPdf({.width = kNan, .height = kNan}));
}

TEST(Pdf, QpdfFindsNothingToComplainAbout) {
  if (std::system("qpdf --version > /dev/null 2>&1") != 0) {
    // Only for who sets SIGHTLINE_NO_SETUP. The tests above judge the files, too.
    GTEST_SKIP() << "qpdf cannot be run (scripts/setup installs it)";
  }
  std::vector<DrawingGroup> groups;
  for (std::uint32_t i = 0; i < 50; ++i) {
    groups.push_back({{object(i, "wall \xc3\xa4 " + std::to_string(i))}});
  }
  groups[3].objects.push_back(object(77, "(more)"));
  const test::TemporaryFolder folder;
  for (const Drawing& drawing : {drawingOf(groups), Drawing{}}) {
    const std::string file = folder.write("a.pdf", toPdf(drawing, {.title = "\xe2\x82\xac"}));
    EXPECT_EQ(std::system(("qpdf --check '" + file + "' > /dev/null 2>&1").c_str()), 0);
  }
}

}  // namespace
}  // namespace sightline
