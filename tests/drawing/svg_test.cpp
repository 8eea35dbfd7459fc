// Drawings as SVG: what a reader makes of the text.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sightline/drawing/drawing.h"
#include "src/drawing/drawing_text.h"
#include "src/drawing/svg_names.h"
#include "tests/drawing/made_drawings.h"
#include "tests/support/layer_shapes.h"

namespace sightline {
namespace {

using shapes::Random;
using test::drawingOf;
using test::object;

struct Element {
  std::string tag;
  std::map<std::string, std::string> attributes;
  std::vector<Element> children;
  std::string text;
};

// As much of XML as the documents use; anything else fails the test that reads it.
class XmlReader {
 public:
  explicit XmlReader(const std::string& text) : text_(text) {}

  std::optional<Element> read() {
    if (!take("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n")) {
      return std::nullopt;
    }
    std::optional<Element> root = element();
    skipSpace();
    return at_ == text_.size() ? root : std::nullopt;
  }

 private:
  bool take(const std::string& word) {
    if (text_.compare(at_, word.size(), word) != 0) {
      return false;
    }
    at_ += word.size();
    return true;
  }
  void skipSpace() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
      ++at_;
    }
  }
  std::string word() {
    const std::size_t from = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 ||
                                  std::string("-_:.").find(text_[at_]) != std::string::npos)) {
      ++at_;
    }
    return text_.substr(from, at_ - from);
  }
  std::optional<std::string> until(char end) {
    std::string value;
    const std::map<std::string, std::string> entities{
        {"amp", "&"}, {"lt", "<"}, {"gt", ">"}, {"quot", "\""}, {"#10", "\n"}, {"#9", "\t"}, {"#13", "\r"}};
    while (at_ < text_.size() && text_[at_] != end) {
      if (text_[at_] == '<' || static_cast<unsigned char>(text_[at_]) < 0x09) {
        return std::nullopt;
      }
      if (text_[at_] != '&') {
        value += text_[at_++];
        continue;
      }
      const std::size_t semicolon = text_.find(';', at_);
      const auto found = entities.find(text_.substr(at_ + 1, semicolon - at_ - 1));
      if (found == entities.end()) {
        return std::nullopt;
      }
      value += found->second;
      at_ = semicolon + 1;
    }
    return value;
  }
  bool attribute(Element& element) {
    const std::string name = word();
    if (name.empty() || !take("=\"")) {
      return false;
    }
    const std::optional<std::string> value = until('"');
    return value && take("\"") && element.attributes.emplace(name, *value).second;
  }
  std::optional<Element> element() {
    skipSpace();
    Element element;
    if (!take("<") || (element.tag = word()).empty()) {
      return std::nullopt;
    }
    while (take(" ")) {
      if (!attribute(element)) {
        return std::nullopt;
      }
    }
    if (take("/>")) {
      return element;
    }
    if (!take(">")) {
      return std::nullopt;
    }
    if (element.tag == "title") {
      const std::optional<std::string> content = until('<');
      element.text = content.value_or("");
    }
    for (skipSpace(); !take("</" + element.tag + ">"); skipSpace()) {
      std::optional<Element> child = this->element();
      if (!child) {
        return std::nullopt;
      }
      element.children.push_back(std::move(*child));
    }
    return element;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

Element parse(const std::string& svg) {
  const std::optional<Element> root = XmlReader(svg).read();
  EXPECT_TRUE(root) << svg.substr(0, 2000);
  return root.value_or(Element{});
}

void collect(const Element& element, const std::string& tag, std::vector<const Element*>& found) {
  if (element.tag == tag) {
    found.push_back(&element);
  }
  for (const Element& child : element.children) {
    collect(child, tag, found);
  }
}

// Path data by the grammar of SVG 1.1, 8.3.9: m, l, h, v and z. A closed path ends with its first point.
std::vector<PagePath> parsePath(const std::string& data) {
  std::vector<PagePath> paths;
  const char* at = data.c_str();
  PagePoint pen;
  char command = ' ';
  const auto number = [&] {
    while (*at == ' ' || *at == '\n' || *at == ',') {
      ++at;
    }
    // strtod would also take "1e5"; a number has one point at most.
    std::string digits;
    digits += *at == '-' ? *at++ : '+';
    bool has_point = false;
    while (std::isdigit(static_cast<unsigned char>(*at)) != 0 || (*at == '.' && !has_point)) {
      has_point = has_point || *at == '.';
      digits += *at++;
    }
    EXPECT_GT(digits.size(), 1u) << data;
    return std::strtod(digits.c_str(), nullptr);
  };
  while (*at != '\0') {
    if (*at == ' ' || *at == '\n') {
      ++at;
      continue;
    }
    if (std::isalpha(static_cast<unsigned char>(*at)) != 0) {
      command = *at++;
      if (command == 'z') {
        paths.back().push_back(paths.back().front());
        pen = paths.back().front();
        continue;
      }
    }
    const char before = command;
    if (command == 'm' || command == 'l' || command == 'h') {
      pen.x += number();
    }
    if (command == 'm' || command == 'l' || command == 'v') {
      pen.y += number();
    }
    if (before == 'm') {
      paths.emplace_back();
      command = 'l';
    }
    EXPECT_TRUE(before == 'm' || before == 'l' || before == 'h' || before == 'v') << data;
    if (paths.empty()) {
      ADD_FAILURE() << data;
      return paths;
    }
    paths.back().push_back(pen);
  }
  return paths;
}

void expectSame(const std::vector<PagePath>& paths, const std::vector<PagePath>& expected, double tolerance) {
  ASSERT_EQ(paths.size(), expected.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    ASSERT_EQ(paths[i].size(), expected[i].size()) << i;
    for (std::size_t k = 0; k < paths[i].size(); ++k) {
      ASSERT_NEAR(paths[i][k].x, expected[i][k].x, tolerance) << i << ", " << k;
      ASSERT_NEAR(paths[i][k].y, expected[i][k].y, tolerance) << i << ", " << k;
    }
  }
}

const Element* byId(const Element& root, const std::string& id) {
  for (const char* tag : {"g", "path", "rect"}) {
    std::vector<const Element*> found;
    collect(root, tag, found);
    for (const Element* element : found) {
      const auto at = element->attributes.find("id");
      if (at != element->attributes.end() && at->second == id) {
        return element;
      }
    }
  }
  return nullptr;
}

TEST(Svg, ObjectsAreNamedGroupsOfAnOutlineBelowAllStrokes) {
  const Drawing drawing = drawingOf({{{object(0, "wall")}}, {{object(1, "door")}}});
  const Element root = parse(toSvg(drawing, {.stroke_width = 0.75, .stroke = "#102030", .paper = "#fffff0"}));
  EXPECT_EQ(root.tag, "svg");
  EXPECT_EQ(root.attributes.at("width"), "640");
  EXPECT_EQ(root.attributes.at("viewBox"), "0 0 640 360");
  const Element* all = byId(root, "drawing");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->attributes.at("stroke"), "#102030");
  EXPECT_EQ(all->attributes.at("stroke-width"), ".75");
  EXPECT_EQ(all->attributes.at("stroke-linejoin"), "round");
  EXPECT_EQ(all->attributes.at("fill"), "none");
  EXPECT_EQ(all->attributes.at("fill-rule"), "evenodd");
  ASSERT_EQ(all->children.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Element& group = all->children[i];
    EXPECT_EQ(group.attributes.at("id"), i == 0 ? "wall" : "door");
    ASSERT_EQ(group.children.size(), 2u);
    EXPECT_EQ(group.children[0].attributes.at("fill"), "#fffff0");
    EXPECT_EQ(group.children[0].attributes.at("stroke"), "none");
    EXPECT_EQ(group.children[1].attributes.size(), 1u);
    const DrawingObject& expected = drawing.groups[i].objects[0];
    PagePath ring = expected.outline[0];
    ring.push_back(ring[0]);
    expectSame(parsePath(group.children[0].attributes.at("d")), {ring}, 1e-9);
    expectSame(parsePath(group.children[1].attributes.at("d")), expected.strokes, 1e-9);
  }
}

TEST(Svg, GroupsOfSeveralObjectsAreNestedWithAllOutlinesFirst) {
  const Element root = parse(toSvg(drawingOf({{{object(0, "ring"), object(1, "rod")}}})));
  const Element* group = byId(root, "group-1");
  ASSERT_TRUE(group);
  ASSERT_EQ(group->children.size(), 3u);
  EXPECT_EQ(group->children[0].attributes.at("stroke"), "none");
  ASSERT_EQ(group->children[0].children.size(), 2u);
  EXPECT_EQ(group->children[0].children[1].attributes.at("id"), "rod-outline");
  EXPECT_EQ(group->children[1].attributes.at("id"), "ring");
  EXPECT_EQ(group->children[2].attributes.at("id"), "rod");
  EXPECT_EQ(group->children[2].children.size(), 1u);
}

TEST(Svg, PlotsHaveNeitherFillsNorPaper) {
  DrawingObject plotted = object(0, "wall");
  plotted.outline.clear();
  const std::string svg = toSvg(drawingOf({{{plotted}}}));
  const Element root = parse(svg);
  std::vector<const Element*> found;
  collect(root, "rect", found);
  EXPECT_TRUE(found.empty());
  EXPECT_EQ(svg.find("fill=\"#"), std::string::npos);
  collect(root, "path", found);
  EXPECT_EQ(found.size(), 1u);
}

TEST(Svg, IdsAreValidAndUniqueAndLabelsKeepTheName) {
  const std::vector<std::string> names{"wall",
                                       "wall",
                                       "wall-2",
                                       "",
                                       "12 rooms",
                                       "a<b>&\"c\"",
                                       "\xc3\xa9t\xc3\xa9",
                                       "\xff\xfe",
                                       std::string("nul\0", 4),
                                       "two\nlines",
                                       "drawing",
                                       "paper",
                                       "group-2",
                                       "\xed\xa0\x80",
                                       "\xf0\x9f\x8f\xa0 house",
                                       "wall"};
  std::vector<DrawingGroup> groups;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    groups.push_back({{object(i, names[i])}});
  }
  groups[1].objects.push_back(object(99, "wall"));
  const std::string svg = toSvg(drawingOf(groups), {.title = "<Plan & \"view\">"});
  const Element root = parse(svg);
  std::set<std::string> ids;
  std::vector<const Element*> all;
  for (const char* tag : {"g", "path", "rect"}) {
    collect(root, tag, all);
  }
  std::multiset<std::string> labels;
  for (const Element* element : all) {
    const auto id = element->attributes.find("id");
    if (id == element->attributes.end()) {
      continue;
    }
    EXPECT_TRUE(ids.insert(id->second).second) << id->second;
    const char first = id->second[0];
    EXPECT_TRUE(std::isalpha(static_cast<unsigned char>(first)) != 0 || first == '_') << id->second;
    for (const char c : id->second) {
      EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.')
          << id->second;
    }
    const auto label = element->attributes.find("inkscape:label");
    labels.insert(label == element->attributes.end() ? id->second : label->second);
  }
  for (const std::string& name :
       {std::string("a<b>&\"c\""), std::string("\xc3\xa9t\xc3\xa9"), std::string("12 rooms"),
        std::string("object 3"), std::string("two\nlines"), std::string("\xf0\x9f\x8f\xa0 house"),
        std::string("wall-2"), std::string("\xef\xbf\xbd\xef\xbf\xbd"), std::string("nul\xef\xbf\xbd")}) {
    EXPECT_TRUE(labels.count(name)) << name;
  }
  EXPECT_EQ(labels.count("wall"), 4u);
  ASSERT_EQ(root.children[0].tag, "title");
  EXPECT_EQ(root.children[0].text, "<Plan & \"view\">");
}

TEST(Svg, RelativeCoordinatesDoNotDrift) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    DrawingObject drawn{.object = ObjectId(0u), .name = "line"};
    for (int i = 0; i < 20; ++i) {
      PagePath path{{random.number(-5, 640), random.number(-5, 360)}};
      for (int k = 0; k < 300; ++k) {
        // Steps along the borders among them, of whole numbers and of less than one.
        const double dx = random.below(4) == 0 ? 0.0 : random.number(-1.7, 2.0);
        const double dy =
            random.below(4) == 0 && dx != 0.0 ? 0.0 : random.number(-2.0, 1.9) + (dx == 0.0 ? 3.0 : 0);
        path.push_back({path.back().x + dx, path.back().y + dy});
      }
      drawn.strokes.push_back(path);
    }
    const Element root = parse(toSvg(drawingOf({{{drawn}}})));
    std::vector<const Element*> paths;
    collect(root, "path", paths);
    ASSERT_EQ(paths.size(), 1u);
    const std::vector<PagePath> read = parsePath(paths[0]->attributes.at("d"));
    ASSERT_EQ(read.size(), drawn.strokes.size()) << "seed " << seed;
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_NEAR(read[i].back().x, drawn.strokes[i].back().x, 0.00501) << "seed " << seed;
      EXPECT_NEAR(read[i].back().y, drawn.strokes[i].back().y, 0.00501) << "seed " << seed;
    }
  }
}

TEST(Svg, SmallPagesHaveMoreDecimals) {
  DrawingObject drawn{.object = ObjectId(0u), .name = "line", .strokes = {{{0.12345, 0.5}, {0.9, 0.25}}}};
  Drawing drawing{.width = 1.0, .height = 1.0, .groups = {{{drawn}}}};
  std::vector<const Element*> paths;
  const Element root = parse(toSvg(drawing, {.stroke_width = 1e-9}));
  collect(root, "path", paths);
  ASSERT_EQ(paths.size(), 1u);
  expectSame(parsePath(paths[0]->attributes.at("d")), drawn.strokes, 0.0001);
  EXPECT_NE(byId(root, "drawing")->attributes.at("stroke-width"), "0");
}

TEST(Svg, WhatIsNotFiniteOrHasNoSizeIsLeftOut) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  DrawingObject drawn{
      .object = ObjectId(0u),
      .name = "x",
      .outline = {{{0, 0}, {1, kNan}, {1, 1}}, {}, {{1, 1}, {1, 1}, {1, 1}}, {{0, 0}, {1, 0}}},
      .strokes = {{}, {{1, 1}}, {{1, 1}, {1.001, 1}}, {{0, 0}, {kInf, 1}}, {{0, 0}, {1e300, 1}}}};
  const std::string svg =
      toSvg(drawingOf({{{drawn}}, {}}), {.stroke_width = kNan, .stroke = "\"/>", .paper = "red"});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  const Element root = parse(svg);
  std::vector<const Element*> paths;
  collect(root, "path", paths);
  ASSERT_EQ(paths.size(), 1u);
  EXPECT_EQ(parsePath(paths[0]->attributes.at("d")).size(), 1u);
  EXPECT_EQ(byId(root, "drawing")->attributes.at("stroke"), "#000000");
  parse(toSvg({}));
}

TEST(Svg, AClosedStrokeHasNoEndsAndAFlatOneIsALine) {
  DrawingObject drawn{.object = ObjectId(0u),
                      .name = "x",
                      .strokes = {{{0, 0}, {5, 0}, {5, 5}, {0, 0}}, {{0, 0}, {5, 0}, {0, 0.001}, {0, 0}}}};
  const std::string svg = toSvg(drawingOf({{{drawn}}}));
  EXPECT_EQ(std::count(svg.begin(), svg.end(), 'z'), 1) << svg;
}

TEST(DecimalGrid, WritesNumbersShort) {
  const drawing::DecimalGrid grid(Drawing{.width = 100, .height = 100});
  const std::vector<std::pair<double, std::string>> expected{{0, "0"},
                                                             {-0.001, "0"},
                                                             {0.5, ".5"},
                                                             {-0.5, "-.5"},
                                                             {0.05, ".05"},
                                                             {12.3, "12.3"},
                                                             {-12.34, "-12.34"},
                                                             {100, "100"},
                                                             {1e9, "1000000000"},
                                                             {-7.104, "-7.1"},
                                                             {1e300, "10000000000000000"}};
  for (const auto& [value, text] : expected) {
    std::string written;
    grid.append(written, grid.round(value));
    EXPECT_EQ(written, text) << value;
  }
}

}  // namespace
}  // namespace sightline
