// The pictures of `reproduce poon-wang`: figures 7 and 11.

#include <fmt/format.h>

#include <algorithm>

#include "tools/sightline/report/markup.h"
#include "tools/sightline/reproduce/poon_wang.h"
#include "tools/sightline/walk/walk_pictures.h"
#include "tools/sightline/walk/walk_report.h"

namespace sightline::tool::poon_wang {
namespace {

void addPicture(const std::string& name, std::uint32_t figure, ReportPicture picture, Image image,
                Pictures& pictures) {
  picture.file = name + ".png";
  picture.frame = figure;
  pictures.files.push_back({picture.file, std::move(image)});
  pictures.pictures.push_back(std::move(picture));
}

}  // namespace

void addTopViews(const Scene& scene, CullingData& data, const View& view, Culler& frustum,
                 std::span<const std::pair<std::string, Setting>> criteria, Renderer& renderer,
                 Pictures& pictures) {
  KeptFrame frame;
  frame.view = view;
  frustum.cull(view);
  frame.in_frustum.assign(frustum.visible().begin(), frustum.visible().end());
  pictures.in_frustum = frame.in_frustum.size();
  for (const auto& [name, setting] : criteria) {
    Culler culler = data.makeCuller(setting);
    culler.cull(view);
    frame.visible.assign(culler.visible().begin(), culler.visible().end());
    frame.occluders.assign(culler.occludersUsed().begin(), culler.occludersUsed().end());
    pictures.hidden.emplace_back(name, frame.in_frustum.size() - frame.visible.size());
    addPicture("figure7_" + name, 7,
               {.caption = fmt::format("{}: {} objects kept, {} hidden in the frustum, {} occluders", name,
                                       grouped(frame.visible.size()), grouped(pictures.hidden.back().second),
                                       grouped(frame.occluders.size())),
                .plan = true,
                .heading = fmt::format("Figure 7: top view of the model, up to {} occluders",
                                       setting.culler.occluders.count)},
               planPicture(frame, scene, data.occluders(), renderer), pictures);
  }
}

void addBirdsEyeView(const Scene& scene, CameraPath path, Renderer& renderer, Pictures& pictures) {
  const Box bounds = sceneBounds(scene.view());
  const Vec3d middle = center(bounds), extent = Vec3d(bounds.extent());
  const double size = std::max(extent.x, extent.z);
  const Vec3d towards{0.0, -0.6 * size, -0.75 * size};  // from the eye to the middle
  path.frames = {{middle - towards, towards, {0.0, 1.0, 0.0}}};
  path.z_far = 10.0 * size;
  std::vector<ObjectId> everything;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    everything.push_back(ObjectId(o));
  }
  addPicture("figure11", 11,
             {.caption = fmt::format("{} triangles in {} objects", grouped(scene.triangleCount()),
                                     grouped(scene.objects.size())),
              .heading = "Figure 11: bird's-eye view of the model"},
             renderer.draw(path.view(0, {}), everything), pictures);
}

Finding topViewFinding(const std::string& scene, const Pictures& pictures) {
  const auto& most =
      *std::ranges::max_element(pictures.hidden, {}, &std::pair<std::string, std::size_t>::second);
  std::string text;
  for (const auto& [name, hidden] : pictures.hidden) {
    text += fmt::format("{}{} of {} objects with {}", text.empty() ? "" : ", ", hidden, pictures.in_frustum,
                        name);
  }
  return {
      "figure 7: with 192 occluders minimum sets hide most of what is in the frustum, the other criteria "
      "less",
      most.first == "minimum-sets",
      fmt::format("{} in {}. As in figure 6, lists that are made for a grid point miss what is seen from "
                  "beside it",
                  text, scene)};
}

}  // namespace sightline::tool::poon_wang
