// What does a changing world cost? A city of instances of one box, from 1,000 to 1,000,000 of them, a walk
// along its streets. On the same frames, processor time of one thread, medians:
//
//   static     a cull of the world in which nothing changes
//   moving     the same with up to 10,000 of the instances moving in every frame
//   update     moving them in one call, and keeping the hierarchy good
//   edits      40 instances added and 40 removed
//   Culler     a Culler of the same boxes by the frustum alone, beside it to set the scale
//   its edits  what a Culler does after any change: a hierarchy anew, and reset()
//
// Then, of the same worlds, what else can be asked in a frame, and what one by one costs:
//
//   two eyes   a cull for both, 64 mm apart
//   shadows    the casters of a sun whose map is 120 m wide, after the camera's cull
//   sight      a question whether a box may be seen from a point, up to 60 m away
//   set origin boxes anew around another origin
//   foreseen   of what appears, the share that viewsAhead() had in its views 0.4 seconds before, at 60 frames
//              a second, and how many times as many instances as are visible it has
//   one by one a static cull where instances were added one at a time instead of as a list
//
// A third table is of worlds whose instances were added one by one:
//
//   add        the longest time that one of them took, after World::reserve()
//   list       a static cull of the same world added as a list
//   single     a static cull before tidy() is called
//   tidied     a static cull after so many calls of tidy(), of which one takes so long, and the longest
//   stream     then a thousand instances removed and a thousand added in a frame, one by one, with tidy(),
//              and the worst of 1,200 such frames
//
// The last one has boxes that all move in every frame, in one call or singly, beside the linear test of as
// many by a Culler.
//
//   world [INSTANCES...]

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "bench/measuring.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/frustum_method.h"
#include "sightline/world/shadow_casters.h"
#include "sightline/world/views_ahead.h"
#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"
#include "sightline/world/world_sight.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr int kFrames = 120, kUncounted = 20;
constexpr std::size_t kAhead = 24;  // frames, 0.4 s
constexpr double kBlock = 24.0;     // metres from street to street

// Processor time, which other work on the machine changes little.
double processorUs(const auto& function) {
  const auto now = [] {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
  };
  const double start = now();
  function();
  return now() - start;
}

Vec3f corner(int i) {
  return {(i & 1) != 0 ? 0.5f : -0.5f, (i & 2) != 0 ? 1.0f : 0.0f, (i & 4) != 0 ? 0.5f : -0.5f};
}

WorldMesh unitBox() {
  std::vector<Vec3f> corners(8);
  for (int i = 0; i < 8; ++i) {
    corners[static_cast<std::size_t>(i)] = corner(i);
  }
  const std::vector<std::uint16_t> indices{0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                           2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return *makeMesh({.positions = corners.data(),
                    .vertex_count = 8,
                    .indices = indices.data(),
                    .index_bytes = 2,
                    .index_count = indices.size()});
}

Mat4 placed(const Vec3d& at, const Vec3d& size, double turn) {
  const double c = std::cos(turn), s = std::sin(turn);
  Mat4 m;
  m(0, 0) = c * size.x, m(0, 2) = s * size.z;
  m(1, 1) = size.y;
  m(2, 0) = -s * size.x, m(2, 2) = c * size.z;
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, 3) = at[axis];
  }
  return m;
}

// One house a block, and nine small things around it.
struct City {
  int blocks;  // along a side
  std::mt19937 engine{1};

  explicit City(std::size_t instances)
      : blocks(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(instances) / 10.0)))) {}

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(engine); }
  Mat4 next(std::size_t i) {
    const auto block = static_cast<int>(i / 10);
    const double x = kBlock * (block % blocks - blocks / 2), z = kBlock * (block / blocks - blocks / 2);
    if (i % 10 == 0) {
      return placed({x, 0, z}, {number(12, 18), number(6, 50), number(12, 18)}, 0.0);
    }
    return small({x, 0, z});
  }
  Mat4 small(const Vec3d& block) {
    const double size = number(0.3, 1.5);
    return placed(block + Vec3d(number(-12, 12), 0, number(-12, 12)), {size, size, size}, number(0, 6));
  }
  View view(int frame) const {
    View view;
    view.eye = {0.5 * kBlock, 1.7, 0.25 * frame};
    setOrientation(view, {0.3 * std::sin(0.05 * frame), 0, 1}, {0, 1, 0});
    view.z_far = 2000.0;
    return view;
  }
};

double settled(const std::vector<double>& values) {
  return medianOf(
      {values.begin() + std::min<std::ptrdiff_t>(kUncounted, std::ssize(values) - 1), values.end()});
}

// The next instances of a city.
std::vector<Instance> instancesOf(City& city, MeshId mesh, std::size_t count) {
  std::vector<Instance> instances;
  for (std::size_t i = 0; i < count; ++i) {
    instances.push_back({.mesh = mesh, .world_from_mesh = city.next(i)});
  }
  return instances;
}

void measure(std::size_t count) {
  City city(count);
  World world;
  const MeshId box = world.addMesh(unitBox());
  const std::vector<Instance> instances = instancesOf(city, box, count);
  std::vector<InstanceId> ids;
  const double build_us = processorUs([&] { world.add(instances, ids); });

  // The same boxes for a Culler.
  std::vector<Box> bounds;
  for (const InstanceId id : ids) {
    bounds.push_back(world.boundsOf(id));
  }
  Hierarchy hierarchy = buildHierarchy(bounds, {});
  Culler by_frustum({.hierarchy = &hierarchy, .object_bounds = bounds}, frustumCulling());

  std::vector<InstanceId> movers;
  for (std::size_t i = 1; i < ids.size() && movers.size() < 10000;
       i += std::max<std::size_t>(count / 10000, 1)) {
    if (i % 10 != 0) {
      movers.push_back(ids[i]);
    }
  }
  std::vector<double> still, moving, update, edits, frustum, reset, kept;
  WorldCuller culler;
  for (int frame = 0; frame < kFrames; ++frame) {
    const View view = city.view(frame);
    still.push_back(processorUs([&] { culler.cull(world, view); }));
    kept.push_back(static_cast<double>(culler.visible().size()));
    frustum.push_back(processorUs([&] { by_frustum.cull(view); }));
  }
  reset.push_back(processorUs([&] {
    hierarchy = buildHierarchy(bounds, {});
    by_frustum.reset();
  }));
  std::vector<Mat4> goals;
  for (int frame = 0; frame < kFrames; ++frame) {
    goals.clear();
    for (const InstanceId id : movers) {
      goals.push_back(instances[id.value].world_from_mesh);
      goals.back()(0, 3) += 3.0 * std::sin(0.05 * frame + 0.1 * id.value);
      goals.back()(2, 3) += 3.0 * std::cos(0.05 * frame + 0.1 * id.value);
    }
    update.push_back(processorUs([&] {
      world.setTransforms(movers, goals);
      world.tidy();
    }));
    const View view = city.view(frame);
    moving.push_back(processorUs([&] { culler.cull(world, view); }));
  }
  for (int frame = 0; frame < kFrames; ++frame) {
    world.tidy();  // all that has moved settles
  }
  std::vector<InstanceId> added;
  for (int frame = 0; frame < kFrames; ++frame) {
    std::vector<Instance> more;
    for (int i = 0; i < 40; ++i) {
      more.push_back({.mesh = box, .world_from_mesh = city.small({0, 0, 0.25 * frame})});
    }
    edits.push_back(processorUs([&] {
      for (const InstanceId id : added) {
        world.remove(id);
      }
      added.clear();
      for (const Instance& instance : more) {
        added.push_back(world.add(instance));
      }
      world.tidy();
    }));
    culler.cull(world, city.view(frame));
  }
  fmt::print("{:>9} {:>8} {:>8.0f} {:>9.0f} {:>9.0f} {:>9.0f} {:>9.1f} {:>9.0f} {:>11.0f} {:>10.0f}\n", count,
             movers.size(), meanOf(kept), settled(still), settled(moving), settled(update), settled(edits),
             settled(frustum), settled(reset), build_us / 1000.0);
  std::fflush(stdout);
}

void measureQuestions(std::size_t count) {
  City city(count);
  World world, one_by_one;
  const MeshId box = world.addMesh(unitBox());
  one_by_one.addMesh(unitBox());
  const std::vector<Instance> instances = instancesOf(city, box, count);
  std::vector<InstanceId> ids;
  world.add(instances, ids);
  const double add_us = processorUs([&] {
    for (const Instance& instance : instances) {
      one_by_one.add(instance);
    }
  });
  for (int i = 0; i < kFrames; ++i) {
    one_by_one.tidy();
  }
  WorldCuller culler, both, apart, forecast;
  std::vector<std::vector<std::uint64_t>> forecasts;
  std::size_t appeared = 0, foreseen = 0, ahead_count = 0, visible_count = 0;
  ShadowCasters sun;
  WorldSight sight;
  std::vector<double> still, eyes, shadows, looks, scattered, casters;
  for (int frame = 0; frame < kFrames; ++frame) {
    const View view = city.view(frame);
    std::array<View, 2> pair{view, view};
    pair[1].eye = view.eye + view.right * 0.064;
    View light;
    light.orthographic = true;
    light.ortho_height = 120.0;
    light.aspect = 1.0;
    setOrientation(light, {0.4, -0.8, 0.3}, {0, 1, 0});
    light.eye = view.eye + view.forward * 50.0 - light.forward * 200.0;
    light.z_far = 400.0;
    still.push_back(processorUs([&] { culler.cull(world, view); }));
    eyes.push_back(processorUs([&] { both.cull(world, pair); }));
    shadows.push_back(processorUs([&] { sun.cull(world, light, culler); }));
    std::array<View, 3> views;
    viewsAhead(view, {.velocity = {0.0, 0.0, 0.25 * 60.0}, .spread = 2.0}, 0.5, views);
    forecast.cull(world, views);
    if (forecasts.size() >= kAhead) {
      const std::vector<std::uint64_t>& before = forecasts[forecasts.size() - kAhead];
      for (const InstanceId id : culler.appeared()) {
        ++appeared;
        foreseen += before[id.value / 64] >> (id.value % 64) & 1;
      }
      ahead_count += forecast.visible().size();
      visible_count += culler.visible().size();
    }
    forecasts.emplace_back(forecast.visibleBits().begin(), forecast.visibleBits().end());
    casters.push_back(static_cast<double>(sun.casters().size()));
    scattered.push_back(processorUs([&] { apart.cull(one_by_one, view); }));
    Box target;
    const Vec3d at = view.eye + Vec3d(city.number(-40, 40), -1.0, city.number(-40, 40));
    target.extend(Vec3f(at));
    target.extend(Vec3f(at + Vec3d(0.5, 1.8, 0.5)));
    looks.push_back(processorUs([&] { sight.look(world, view.eye, target); }));
  }
  fmt::print("{:>9} {:>9.0f} {:>9.0f} {:>9.0f} {:>9.0f} {:>9.1f} {:>10.0f} {:>12.2f}", count, settled(still),
             settled(eyes), settled(shadows), meanOf(casters), settled(looks), settled(scattered),
             add_us / static_cast<double>(count));
  fmt::print(" {:>8.0f} % {:>6.2f}\n",
             100.0 * static_cast<double>(foreseen) / static_cast<double>(std::max<std::size_t>(appeared, 1)),
             static_cast<double>(ahead_count) / static_cast<double>(std::max<std::size_t>(visible_count, 1)));
  std::fflush(stdout);
}

// Boxes that all move, among a hundred thousand instances that do not.
void measureMovers(std::size_t count) {
  City city(100000);
  World world;
  const MeshId mesh = world.addMesh(unitBox()), mover = world.addMesh(boxMesh({{-1, 0, -1}, {1, 2, 1}}));
  std::vector<Instance> instances = instancesOf(city, mesh, 100000);
  std::vector<InstanceId> ids;
  world.add(instances, ids);
  std::vector<Box> bounds;
  for (const InstanceId id : ids) {
    bounds.push_back(world.boundsOf(id));
  }
  const Hierarchy hierarchy = buildHierarchy(bounds, {});
  Culler linear({.hierarchy = &hierarchy, .object_bounds = bounds}, frustumCulling());
  std::vector<InstanceId> movers;
  std::vector<Instance> added;
  std::vector<Mat4> goals;
  for (std::size_t i = 0; i < count; ++i) {
    goals.push_back(placed({city.number(-1200, 1200), 0, city.number(-1200, 1200)}, {1, 1, 1}, 0.0));
    added.push_back({.mesh = mover, .world_from_mesh = goals.back(), .moves = true});
  }
  world.add(added, movers);
  WorldCuller culler, without;
  World empty_of_movers;
  std::vector<InstanceId> other;
  const MeshId same = empty_of_movers.addMesh(unitBox());
  for (Instance& instance : instances) {
    instance.mesh = same;
  }
  empty_of_movers.add(instances, other);
  std::vector<double> still, moving, singly, update, frustum, frustum_boxes;
  std::vector<Box> boxes(count);
  for (int frame = 0; frame < kFrames; ++frame) {
    for (std::size_t i = 0; i < count; ++i) {
      goals[i](0, 3) += 0.1 * std::cos(0.02 * static_cast<double>(i));
      goals[i](2, 3) += 0.1 * std::sin(0.02 * static_cast<double>(i));
      boxes[i] = {{static_cast<float>(goals[i](0, 3)) - 1, 0, static_cast<float>(goals[i](2, 3)) - 1},
                  {static_cast<float>(goals[i](0, 3)) + 1, 2, static_cast<float>(goals[i](2, 3)) + 1}};
    }
    // By turns, so that other work on the machine slows down both.
    const bool one_by_one = frame % 2 == 0;
    (one_by_one ? singly : update).push_back(processorUs([&] {
      for (std::size_t i = 0; i < count && one_by_one; ++i) {
        world.setTransform(movers[i], goals[i]);
      }
      if (!one_by_one) {
        world.setTransforms(movers, goals);
      }
      world.tidy();
    }));
    const View view = city.view(frame);
    moving.push_back(processorUs([&] { culler.cull(world, view); }));
    still.push_back(processorUs([&] { without.cull(empty_of_movers, view); }));
    frustum.push_back(processorUs([&] { linear.cull(view); }));
    frustum_boxes.push_back(processorUs([&] { linear.cull(view, boxes); }));
  }
  fmt::print("{:>9} {:>9.0f} {:>12.0f} {:>9.0f} {:>9.0f} {:>14.0f}\n", count, settled(still),
             settled(moving) - settled(still), settled(update), settled(singly),
             settled(frustum_boxes) - settled(frustum));
  std::fflush(stdout);
}

// A world of instances that were added one by one, while tidy() builds its hierarchy anew; then cells that
// come and go in it.
void measureChanges(std::size_t count) {
  City city(count);
  World world, as_list;
  const MeshId box = world.addMesh(unitBox());
  as_list.addMesh(unitBox());
  world.reserve(count);
  const std::vector<Instance> instances = instancesOf(city, box, count);
  std::vector<double> adding;
  std::vector<InstanceId> ids;
  for (const Instance& instance : instances) {
    adding.push_back(processorUs([&] { ids.push_back(world.add(instance)); }));
  }
  std::vector<InstanceId> listed;
  as_list.add(instances, listed);
  const auto culled = [&](const World& of) {
    WorldCuller culler;
    std::vector<double> times;
    for (int frame = 0; frame < kFrames; ++frame) {
      const View view = city.view(frame);
      times.push_back(processorUs([&] { culler.cull(of, view); }));
    }
    return settled(times);
  };
  const double before = culled(world);
  std::vector<double> calls;
  for (int idle = 0; idle < 60; ++idle) {
    const double us = processorUs([&] { world.tidy(); });
    if (us > 2.0) {
      calls.push_back(us);
      idle = 0;
    }
  }
  const double after = culled(world), list = culled(as_list);
  const auto largest = [](const std::vector<double>& values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
  };

  // Cells are streamed: of each frame's thousand, all came in together and go together.
  constexpr std::size_t kOfFrame = 1000;
  std::vector<double> stream, cull;
  WorldCuller culler;
  for (int frame = 0; frame < 10 * kFrames && count >= 10 * kOfFrame; ++frame) {
    const std::size_t first = static_cast<std::size_t>(frame) % (count / kOfFrame) * kOfFrame;
    stream.push_back(processorUs([&] {
      for (std::size_t i = first; i < first + kOfFrame; ++i) {
        world.remove(ids[i]);
      }
      for (std::size_t i = first; i < first + kOfFrame; ++i) {
        ids[i] = world.add(instances[i]);
      }
      world.tidy();
    }));
    const View view = city.view(frame % kFrames);
    cull.push_back(processorUs([&] { culler.cull(world, view); }));
  }
  fmt::print("{:>9} {:>9.0f} {:>9.0f} {:>9.0f} {:>9.0f} {:>7} {:>9.0f} {:>10.0f}", count, largest(adding),
             list, before, after, calls.size(), settled(calls), largest(calls));
  if (!stream.empty()) {
    fmt::print(" {:>10.0f} {:>9.0f} {:>9.0f}", settled(stream), largest(stream), settled(cull));
  }
  fmt::print("\n");
  std::fflush(stdout);
}

// A new origin, at once and in slices of tidy(), while a twentieth of the instances moves.
void measureOrigins(std::size_t count) {
  City city(count);
  World world;
  const MeshId box = world.addMesh(unitBox());
  std::vector<InstanceId> ids, movers;
  const std::vector<Instance> instances = instancesOf(city, box, count);
  world.add(instances, ids);
  std::vector<Mat4> goals;
  for (std::size_t i = 1; i < count && movers.size() < 10000; i += 20) {
    movers.push_back(ids[i]);
    goals.push_back(instances[i].world_from_mesh);
  }
  const auto frame = [&](WorldCuller& culler, int number, std::vector<double>& update,
                         std::vector<double>& cull) {
    for (Mat4& goal : goals) {
      goal(0, 3) += number % 2 == 0 ? 0.5 : -0.5;
    }
    update.push_back(processorUs([&] {
      world.setTransforms(movers, goals);
      world.tidy();
    }));
    const View view = city.view(number % kFrames);
    cull.push_back(processorUs([&] { culler.cull(world, view); }));
  };
  std::vector<double> at_once, before, before_cull, slices, cull;
  WorldCuller culler;
  for (int number = 0; number < kFrames; ++number) {
    frame(culler, number, before, before_cull);
    if (number % 20 == 19) {
      at_once.push_back(processorUs([&] { world.setOrigin({0.0, 0.0, number % 40 == 19 ? 16.0 : 0.0}); }));
    }
  }
  world.moveOrigin({0.0, 0.0, 32.0});
  while (world.origin().z != 32.0) {
    frame(culler, static_cast<int>(slices.size()), slices, cull);
  }
  fmt::print("{:>9} {:>8} {:>10.2f} {:>9.0f} {:>9.0f} {:>7} {:>9.0f} {:>10.0f} {:>9.0f}\n", count,
             movers.size(), medianOf(at_once) / 1000.0, settled(before), settled(before_cull), slices.size(),
             medianOf(slices), *std::max_element(slices.begin(), slices.end()), medianOf(cull));
  std::fflush(stdout);
}

// Boxes that all move, and a crowd of a tenth of them whose members change places by small steps: how much
// larger the cull of a view of the crowd becomes.
void measureCrowd(std::size_t count) {
  City city(count);
  World world;
  const MeshId mover = world.addMesh(boxMesh({{-0.5f, 0, -0.5f}, {0.5f, 2, 0.5f}}));
  constexpr double kHalf = 1000.0;
  std::vector<Instance> instances;
  std::vector<std::size_t> crowd;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d at(city.number(-kHalf, kHalf), 0, city.number(-kHalf, kHalf));
    instances.push_back({.mesh = mover, .world_from_mesh = placed(at, {1, 1, 1}, 0.0), .moves = true});
    if (std::max(std::abs(at.x), std::abs(at.z)) < 0.316 * kHalf) {
      crowd.push_back(i);
    }
  }
  std::vector<InstanceId> ids;
  world.add(instances, ids);
  std::vector<InstanceId> movers;
  std::vector<Mat4> from, goals;
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    movers.push_back(ids[crowd[i]]);
    from.push_back(instances[crowd[i]].world_from_mesh);
    goals.push_back(instances[crowd[(7 * i + 1) % crowd.size()]].world_from_mesh);
  }
  View view = city.view(0);
  view.eye = {0.0, 30.0, -250.0};
  setOrientation(view, {0, -0.2, 1}, {0, 1, 0});
  view.z_far = 500.0;
  const auto culled = [&](const World& of) {
    WorldCuller culler;
    std::vector<double> times;
    for (int frame = 0; frame < kFrames; ++frame) {
      times.push_back(processorUs([&] { culler.cull(of, view); }));
    }
    return std::pair(settled(times), culler.stats().boxes_tested);
  };
  const auto [fresh_us, fresh_boxes] = culled(world);
  constexpr int kSteps = 600;
  std::vector<double> updates;
  std::uint32_t most = 0;
  WorldCuller culler;
  std::vector<Mat4> now = from;
  for (int step = 1; step <= kSteps; ++step) {
    const double part = static_cast<double>(step) / kSteps;
    for (std::size_t i = 0; i < now.size(); ++i) {
      now[i](0, 3) = from[i](0, 3) + part * (goals[i](0, 3) - from[i](0, 3));
      now[i](2, 3) = from[i](2, 3) + part * (goals[i](2, 3) - from[i](2, 3));
    }
    updates.push_back(processorUs([&] {
      world.setTransforms(movers, now);
      world.tidy();
    }));
    culler.cull(world, view);
    most = std::max(most, culler.stats().boxes_tested);
  }
  const auto [worn_us, worn_boxes] = culled(world);
  world.rebuild();
  const auto [rebuilt_us, rebuilt_boxes] = culled(world);
  fmt::print("{:>9} {:>8} {:>9.0f} {:>9.0f} {:>9.0f} {:>8} {:>8} {:>8} {:>8} {:>9.0f} {:>9.0f}\n", count,
             crowd.size(), fresh_us, worn_us, rebuilt_us, fresh_boxes, most, worn_boxes, rebuilt_boxes,
             settled(updates), *std::max_element(updates.begin(), updates.end()));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  std::vector<std::size_t> counts;
  for (const std::string& word : arguments.words) {
    counts.push_back(std::strtoull(word.c_str(), nullptr, 10));
  }
  if (counts.empty()) {
    counts = arguments.brief ? std::vector<std::size_t>{1000}
                             : std::vector<std::size_t>{1000, 10000, 100000, 1000000};
  }
  fmt::print("{:>9} {:>8} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>11} {:>10}\n", "instances", "moving", "kept",
             "static us", "moving us", "update us", "edits us", "Culler us", "its edits us", "added ms");
  for (const std::size_t count : counts) {
    measure(count);
  }
  fmt::print("\n{:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>12} {:>10} {:>6}\n", "instances", "static us",
             "eyes us", "shadow us", "casters", "sight us", "scatter us", "add one us", "foreseen", "times");
  for (const std::size_t count : counts) {
    measureQuestions(count);
  }
  fmt::print("\n{:>9} {:>9} {:>9} {:>9} {:>9} {:>7} {:>9} {:>10} {:>10} {:>9} {:>9}\n", "instances", "add us",
             "list us", "single us", "tidied us", "calls", "call us", "longest us", "stream us", "worst us",
             "cull us");
  for (const std::size_t count : counts) {
    measureChanges(count);
  }
  fmt::print("\n{:>9} {:>9} {:>12} {:>9} {:>9} {:>14}\n", "movers", "static us", "+ movers us", "update us",
             "singly us", "Culler boxes us");
  for (const std::size_t count : arguments.brief ? std::vector<std::size_t>{1000}
                                                 : std::vector<std::size_t>{1000, 5000, 20000, 80000}) {
    measureMovers(count);
  }
  fmt::print("\n{:>9} {:>8} {:>10} {:>9} {:>9} {:>7} {:>9} {:>10} {:>9}\n", "instances", "moving",
             "at once ms", "update us", "cull us", "calls", "update us", "longest us", "cull us");
  for (const std::size_t count : counts) {
    measureOrigins(count);
  }
  fmt::print("\n{:>9} {:>8} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n", "boxes", "crowd",
             "fresh us", "worn us", "anew us", "boxes", "most", "worn", "anew", "update us", "longest");
  for (const std::size_t count :
       arguments.brief ? std::vector<std::size_t>{1000} : std::vector<std::size_t>{10000, 100000}) {
    measureCrowd(count);
  }
}
