// Drawings as PDF. Source: ISO 32000-1:2008, 8.11 (optional content), 7.5 (file structure).

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "sightline/drawing/drawing.h"
#include "src/drawing/drawing_text.h"
#include "src/drawing/pdf_file.h"

namespace sightline {

using namespace drawing;

namespace {

class PdfWriter {
 public:
  PdfWriter(const Drawing& drawing, const DrawingStyle& style)
      : drawing_(&drawing), style_(usableStyle(style)), grid_(drawing) {}

  std::string write() {
    const std::size_t catalogue = file_.reserve(), pages = file_.reserve(), page = file_.reserve(),
                      contents = file_.reserve(), info = file_.reserve();
    // A PDF's page must have a size even if the drawing has none.
    const std::string width = grid_.lengthText(drawing_->width > 0.0 ? drawing_->width : 1.0);
    const std::string height = grid_.lengthText(drawing_->height > 0.0 ? drawing_->height : 1.0);
    const std::string marks = pageContents();
    addCatalogue(catalogue, pages);
    file_.add(pages, fmt::format("<< /Type /Pages /Kids [{} 0 R] /Count 1 >>", page));
    file_.add(page, fmt::format("<< /Type /Page /Parent {} 0 R /MediaBox [0 0 {} {}] /Contents {} 0 R "
                                "/Resources << /ProcSet [/PDF] /Properties <<{} >> >> >>",
                                pages, width, height, contents, properties_));
    file_.addStream(contents, marks);
    file_.add(info, fmt::format("<< /Title {} /Producer (Sightline) >>", pdfString(style_.title)));
    return file_.finish(catalogue, info);
  }

 private:
  // Readers list layers in the order of `Order`: front ones first, a group as a branch.
  void addCatalogue(std::size_t number, std::size_t pages) {
    std::string all, order;
    for (const std::size_t layer : layers_) {
      fmt::format_to(std::back_inserter(all), " {} 0 R", layer);
    }
    for (auto branch = branches_.rbegin(); branch != branches_.rend(); ++branch) {
      order += *branch;
    }
    file_.add(number, fmt::format("<< /Type /Catalog /Pages {} 0 R /PageMode /UseOC /OCProperties "
                                  "<< /OCGs [{} ] /D << /Name (Objects) /Order [{} ] >> >> >>",
                                  pages, all, order));
  }

  // The page's drawing commands, with y pointing down as in the drawing.
  std::string pageContents() {
    text_.clear();
    fmt::format_to(std::back_inserter(text_), "1 0 0 -1 0 {} cm\n1 J 1 j {} w\n{} RG {} rg\n",
                   grid_.lengthText(drawing_->height), grid_.lengthText(style_.stroke_width),
                   colour(style_.stroke), colour(style_.paper));
    if (hasOutlines(*drawing_)) {
      fmt::format_to(std::back_inserter(text_), "0 0 {} {} re f\n", grid_.lengthText(drawing_->width),
                     grid_.lengthText(drawing_->height));
    }
    for (std::size_t i = 0; i < drawing_->groups.size(); ++i) {
      addGroup(drawing_->groups[i], i);
    }
    return std::move(text_);
  }

  // The colour as three numbers from 0 to 1.
  static std::string colour(const std::string& text) {
    const std::array<int, 3> rgb = *parseColour(text);
    return fmt::format("{:.3g} {:.3g} {:.3g}", rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
  }

  // Writes all outlines, then all strokes; both paths of an object are marked with its layer.
  void addGroup(const DrawingGroup& group, std::size_t number) {
    std::vector<std::size_t> layers;
    for (const DrawingObject& object : group.objects) {
      layers.push_back(object.outline.empty() && object.strokes.empty() ? 0 : addLayer(object));
    }
    for (std::size_t i = 0; i < layers.size(); ++i) {
      mark(layers[i], group.objects[i].outline, true);
      if (layers.size() == 1) {
        mark(layers[i], group.objects[i].strokes, false);
      }
    }
    for (std::size_t i = 0; layers.size() > 1 && i < layers.size(); ++i) {
      mark(layers[i], group.objects[i].strokes, false);
    }
    std::string branch;
    for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
      branch += *layer != 0 ? fmt::format(" {} 0 R", *layer) : "";
    }
    branches_.push_back(group.objects.size() > 1 && !branch.empty()
                            ? fmt::format(" [(Group {}){}]", number + 1, branch)
                            : branch);
  }

  std::size_t addLayer(const DrawingObject& object) {
    const std::size_t layer = file_.reserve();
    file_.add(layer, fmt::format("<< /Type /OCG /Name {} >>", pdfString(nameOf(object))));
    fmt::format_to(std::back_inserter(properties_), " /L{} {} 0 R", layer, layer);
    layers_.push_back(layer);
    return layer;
  }

  void mark(std::size_t layer, const std::vector<PagePath>& paths, bool rings) {
    const std::size_t before = text_.size();
    fmt::format_to(std::back_inserter(text_), "/OC /L{} BDC\n", layer);
    bool is_empty = true;
    for (const PagePath& path : paths) {
      if (grid_.round(path, rings, rounded_)) {
        add(rounded_);
        is_empty = false;
      }
    }
    if (is_empty) {
      text_.resize(before);
      return;
    }
    text_ += rings ? "f*\nEMC\n" : "S\nEMC\n";
  }

  void add(const RoundedPath& path) {
    char command = 'm';
    for (const RoundedPoint& p : path.points) {
      grid_.append(text_, p.x);
      text_ += ' ';
      grid_.append(text_, p.y);
      text_ += ' ';
      text_ += std::exchange(command, 'l');
      text_ += '\n';
    }
    text_ += path.closed ? "h\n" : "";
  }

  const Drawing* drawing_;
  DrawingStyle style_;
  DecimalGrid grid_;
  PdfFile file_;
  std::vector<std::size_t> layers_;    // the layers' object numbers
  std::vector<std::string> branches_;  // of Order, one for each group
  std::string properties_, text_;
  RoundedPath rounded_;
};

}  // namespace

std::string toPdf(const Drawing& drawing, const DrawingStyle& style) {
  return PdfWriter(drawing, style).write();
}

}  // namespace sightline
