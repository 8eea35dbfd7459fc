#include "tools/sightline/methods/baseline.h"

#include <algorithm>

namespace sightline::tool {

std::vector<Setting> withBaseline(std::vector<Setting> settings) {
  const auto is_frustum = [](const Setting& setting) { return setting.method->name == "frustum"; };
  const auto frustum = std::find_if(settings.begin(), settings.end(), is_frustum);
  Setting baseline = settings.front();
  baseline.method = &methodNamed("frustum");
  baseline.choice = nullptr;
  if (frustum != settings.end()) {
    baseline = *frustum;
    settings.erase(frustum);
  }
  settings.insert(settings.begin(), baseline);
  return settings;
}

}  // namespace sightline::tool
