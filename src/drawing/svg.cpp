// Writes drawings as SVG.
//
// One <g> around all holds the attributes that most paths share, so that a path has no attributes but its
// coordinates and, if it is an outline, its fill. There are no style sheets, so programs that know none
// (plotters, cutters) draw the file too.

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>

#include "sightline/drawing/drawing.h"
#include "src/drawing/drawing_text.h"
#include "src/drawing/svg_names.h"

namespace sightline {

using namespace drawing;

namespace {

// Writes paths with relative coordinates, and with h and v for horizontal and vertical lines.
class PathData {
 public:
  explicit PathData(const DecimalGrid& grid) : grid_(&grid) {}

  void add(const PagePath& path, bool ring) {
    if (!grid_->round(path, ring, rounded_)) {
      return;
    }
    text_ += text_.empty() ? "" : "\n";
    command_ = ' ';
    const RoundedPoint& start = rounded_.points.front();
    put('m', start);
    command_ = 'l';  // the meaning of coordinates that follow an m
    for (std::size_t i = 1; i < rounded_.points.size(); ++i) {
      line(rounded_.points[i]);
    }
    if (rounded_.closed) {
      text_ += 'z';
      at_ = start;
    }
  }
  const std::string& text() const { return text_; }

 private:
  void number(std::int64_t steps, bool is_first) {
    text_ += is_first || steps < 0 ? "" : " ";
    grid_->append(text_, steps);
  }
  // Returns true if the letter was written, so that no space is needed.
  bool letter(char command) {
    if (command_ == command) {
      return false;
    }
    text_ += command;
    command_ = command;
    return true;
  }
  void put(char command, const RoundedPoint& p) {
    const bool is_new = letter(command);
    number(p.x - at_.x, is_new);
    number(p.y - at_.y, false);
    at_ = p;
  }
  void line(const RoundedPoint& p) {
    if (p.y == at_.y) {
      const bool is_new = letter('h');
      number(p.x - at_.x, is_new);
      at_ = p;
    } else if (p.x == at_.x) {
      const bool is_new = letter('v');
      number(p.y - at_.y, is_new);
      at_ = p;
    } else {
      put('l', p);
    }
  }

  const DecimalGrid* grid_;
  std::string text_;
  RoundedPath rounded_;
  RoundedPoint at_;
  char command_ = ' ';
};

class SvgWriter {
 public:
  SvgWriter(const Drawing& drawing, const DrawingStyle& style)
      : drawing_(&drawing), style_(usableStyle(style)), grid_(drawing) {}

  std::string write() {
    head();
    for (std::size_t i = 0; i < drawing_->groups.size(); ++i) {
      const DrawingGroup& group = drawing_->groups[i];
      if (group.objects.size() == 1) {
        alone(group.objects[0]);
      } else if (!group.objects.empty()) {
        together(group, i);
      }
    }
    text_ += "</g>\n</svg>\n";
    return std::move(text_);
  }

 private:
  template <typename... Values>
  void print(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
  }

  void head() {
    const std::string width = grid_.lengthText(drawing_->width), height = grid_.lengthText(drawing_->height);
    print("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    print(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" version=\"1.1\" "
        "width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n",
        width, height);
    if (!style_.title.empty()) {
      print("<title>{}</title>\n", escapeXml(style_.title));
    }
    if (hasOutlines(*drawing_)) {
      print("<rect id=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", ids_.make("paper"), width, height,
            style_.paper);
    }
    print(
        "<g id=\"{}\" fill=\"none\" fill-rule=\"evenodd\" stroke=\"{}\" stroke-width=\"{}\" "
        "stroke-linecap=\"round\" stroke-linejoin=\"round\">\n",
        ids_.make("drawing"), style_.stroke, grid_.lengthText(style_.stroke_width));
  }

  // Editors show the label; the id may differ from the name.
  void openGroup(const std::string& name) {
    const std::string id = ids_.make(name);
    print("<g id=\"{}\"", id);
    if (id != name) {
      print(" inkscape:label=\"{}\"", escapeXml(name));
    }
    text_ += ">\n";
  }

  std::string outlineOf(const DrawingObject& object) const {
    PathData data(grid_);
    for (const PagePath& ring : object.outline) {
      data.add(ring, true);
    }
    return data.text();
  }
  std::string strokesOf(const DrawingObject& object) const {
    PathData data(grid_);
    for (const PagePath& stroke : object.strokes) {
      data.add(stroke, false);
    }
    return data.text();
  }

  void alone(const DrawingObject& object) {
    const std::string outline = outlineOf(object), strokes = strokesOf(object);
    if (outline.empty() && strokes.empty()) {
      return;
    }
    openGroup(nameOf(object));
    if (!outline.empty()) {
      print("<path fill=\"{}\" stroke=\"none\" d=\"{}\"/>\n", style_.paper, outline);
    }
    if (!strokes.empty()) {
      print("<path d=\"{}\"/>\n", strokes);
    }
    text_ += "</g>\n";
  }

  // All outlines lie below all strokes, so they cannot be in the objects' own groups.
  void together(const DrawingGroup& group, std::size_t number) {
    const std::string name = fmt::format("group-{}", number + 1);
    print("<g id=\"{}\">\n", ids_.make(name));
    const std::size_t before = text_.size();
    print("<g id=\"{}\" fill=\"{}\" stroke=\"none\">\n", ids_.make(name + "-outlines"), style_.paper);
    const std::size_t empty = text_.size();
    for (const DrawingObject& object : group.objects) {
      if (const std::string outline = outlineOf(object); !outline.empty()) {
        print("<path id=\"{}\" d=\"{}\"/>\n", ids_.make(nameOf(object) + "-outline"), outline);
      }
    }
    if (text_.size() == empty) {
      text_.resize(before);
    } else {
      text_ += "</g>\n";
    }
    for (const DrawingObject& object : group.objects) {
      if (const std::string strokes = strokesOf(object); !strokes.empty()) {
        openGroup(nameOf(object));
        print("<path d=\"{}\"/>\n</g>\n", strokes);
      }
    }
    text_ += "</g>\n";
  }

  const Drawing* drawing_;
  DrawingStyle style_;
  DecimalGrid grid_;
  XmlIds ids_;
  std::string text_;
};

}  // namespace

std::string toSvg(const Drawing& drawing, const DrawingStyle& style) {
  return SvgWriter(drawing, style).write();
}

}  // namespace sightline
