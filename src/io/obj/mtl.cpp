#include "src/io/obj/mtl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "src/io/failure.h"
#include "src/io/obj/obj_lines.h"

namespace sightline::io {
namespace {

// Up to three numbers; those that are not there are like the first.
using Numbers = std::array<double, 3>;

std::optional<Numbers> numbersIn(std::string_view value) {
  value = withoutComment(value);
  Numbers numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string_view word = takeWord(value);
    const std::optional<double> number = word.empty() && i > 0 ? numbers[0] : numberOf(word);
    if (!number || std::isnan(*number)) {
      return std::nullopt;
    }
    numbers[i] = *number;
  }
  return numbers;
}

void makeLessOpaque(Material& material, double opacity) {
  if (opacity < 1.0) {
    material.opacity = Opacity::kBlended;
    material.base_color[3] = std::min(material.base_color[3], static_cast<float>(std::max(opacity, 0.0)));
  }
}

// Takes a word off the front if it is this one.
bool takeOption(std::string_view& value, std::string_view option) {
  std::string_view rest = value;
  const bool there = isKeyword(takeWord(rest), option);
  value = there ? rest : value;
  return there;
}

// False if the statement ought to have numbers and has none.
bool readStatement(std::string_view keyword, std::string_view value, Material& material) {
  if (isKeyword(keyword, "kd")) {
    // Spectra and other colour spaces leave the colour as it is.
    if (const std::optional<Numbers> color = numbersIn(value)) {
      for (std::size_t i = 0; i < 3; ++i) {
        material.base_color[i] = static_cast<float>(std::clamp((*color)[i], 0.0, 1.0));
      }
    }
    return true;
  }
  if (isKeyword(keyword, "d") || isKeyword(keyword, "tr")) {
    takeOption(value, "-halo");  // opaque or not in the same way, but more so towards the outline
    const std::optional<Numbers> number = numbersIn(value);
    if (number) {
      makeLessOpaque(material, isKeyword(keyword, "d") ? (*number)[0] : 1.0 - (*number)[0]);
    }
    return number.has_value();
  }
  if (isKeyword(keyword, "tf")) {
    // What is filtered has come through. Exporters write Tf 1 1 1 where nothing does.
    if (takeOption(value, "spectral")) {
      makeLessOpaque(material, 0.0);
      return true;
    }
    takeOption(value, "xyz");
    const std::optional<Numbers> filter = numbersIn(value);
    if (filter && *std::min_element(filter->begin(), filter->end()) < 1.0) {
      material.opacity = Opacity::kBlended;
    }
    return filter.has_value();
  }
  if (isKeyword(keyword, "illum")) {
    // Models of refraction and of glass. Maya writes 4, which is glass too, for whatever it exports.
    const std::optional<Numbers> model = numbersIn(value);
    if (model && ((*model)[0] == 6.0 || (*model)[0] == 7.0 || (*model)[0] == 9.0)) {
      material.opacity = Opacity::kBlended;
    }
    return true;
  }
  if ((isKeyword(keyword, "map_d") || isKeyword(keyword, "map_tr") || isKeyword(keyword, "map_opacity")) &&
      material.opacity == Opacity::kOpaque) {
    material.opacity = Opacity::kAlphaTested;
  }
  return true;
}

}  // namespace

Status MtlMaterials::read(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t current = kNone;
  for (ObjStatements statements(bytes, ObjStatements::Backslash::kIsText); statements.next();) {
    if (isKeyword(statements.keyword(), "newmtl")) {
      const auto [found, added] =
          by_name_.try_emplace(std::string(statements.value()), static_cast<std::int64_t>(materials_.size()));
      current = static_cast<std::size_t>(found->second);
      if (added) {
        Material material;
        material.name = statements.value();
        material.base_color = {kMtlColor, kMtlColor, kMtlColor, 1.0f};
        materials_.push_back(std::move(material));
        const std::string_view beginning = nameWithoutComment(statements.value());
        if (beginning.size() < statements.value().size()) {
          const auto [other, alone] = by_beginning_.try_emplace(std::string(beginning), found->second);
          other->second = alone ? other->second : -1;
        }
      }
    } else if (current != kNone &&
               !readStatement(statements.keyword(), statements.value(), materials_[current])) {
      return failure("{}: line {}: \"{} {}\" needs a number; give it, or leave the line out", name,
                     statements.line(), excerpt(statements.keyword()), excerpt(statements.value()));
    }
  }
  return Success{};
}

std::int64_t MtlMaterials::find(std::string_view value) const {
  if (const auto found = by_name_.find(std::string(value)); found != by_name_.end()) {
    return found->second;
  }
  if (const auto found = by_name_.find(std::string(nameWithoutComment(value))); found != by_name_.end()) {
    return found->second;
  }
  const auto found = by_beginning_.find(std::string(value));
  return found != by_beginning_.end() ? found->second : -1;
}

std::vector<std::string> picturesOfMtl(std::string_view bytes) {
  constexpr std::array<std::string_view, 5> kOthers{"bump", "disp", "decal", "refl", "norm"};
  std::vector<std::string> pictures;
  for (ObjStatements statements(bytes, ObjStatements::Backslash::kIsText); statements.next();) {
    const std::string_view keyword = statements.keyword();
    if (isKeyword(keyword.substr(0, 4), "map_") ||
        std::any_of(kOthers.begin(), kOthers.end(),
                    [&](std::string_view other) { return isKeyword(keyword, other); })) {
      pictures.emplace_back(statements.value());
    }
  }
  return pictures;
}

}  // namespace sightline::io
