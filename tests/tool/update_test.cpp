// Tests `bake --update`: the file is that of a full bake of the scene after a change, and what cannot be
// updated is refused or told of.

#include <algorithm>
#include <array>
#include <functional>

#include "tests/tool/start_tool.h"
#include "tools/sightline/command_line/parse_text.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

// A closed box with its sides along the axes.
struct Crate {
  std::array<double, 3> low, high;
};

// An OBJ file with one object per box.
std::string objOf(const std::vector<Crate>& crates) {
  constexpr std::array<const char*, 6> kFaces{"1 5 7 3", "2 4 8 6", "1 2 6 5",
                                              "3 7 8 4", "1 3 4 2", "5 6 8 7"};
  std::string text;
  for (std::size_t c = 0; c < crates.size(); ++c) {
    text += "o crate" + std::to_string(c) + "\n";
    for (unsigned i = 0; i < 8; ++i) {
      text += "v";
      for (unsigned axis = 0; axis < 3; ++axis) {
        text += " " + std::to_string((i >> axis & 1) != 0 ? crates[c].high[axis] : crates[c].low[axis]);
      }
      text += "\n";
    }
    for (const char* face : kFaces) {
      std::string line = "f";
      for (const char* at = face; *at != '\0'; at += at[1] == ' ' ? 2 : 1) {
        line += " " + std::to_string(8 * c + static_cast<std::size_t>(*at - '0'));
      }
      text += line + "\n";
    }
  }
  return text;
}

// Two rooms with a door between them, and things in both.
std::vector<Crate> rooms() {
  std::vector<Crate> crates{{{-0.25, -0.25, -0.25}, {12.25, 0, 6.25}},
                            {{-0.25, 3, -0.25}, {12.25, 3.25, 6.25}},
                            {{-0.25, 0, -0.25}, {0, 3, 6.25}},
                            {{12, 0, -0.25}, {12.25, 3, 6.25}},
                            {{0, 0, -0.25}, {12, 3, 0}},
                            {{0, 0, 6}, {12, 3, 6.25}},
                            {{6, 0, 0}, {6.25, 3, 4}},
                            {{6, 0, 5}, {6.25, 3, 6}},
                            {{6, 2, 4}, {6.25, 3, 5}}};
  for (int i = 0; i < 24; ++i) {
    const double x = 0.5 + 1.4 * (i % 8), z = 0.5 + 1.75 * (i / 8), size = 0.25 + 0.125 * (i % 4);
    if (x + size < 6 || x > 6.25) {
      crates.push_back({{x, 0, z}, {x + size, 0.5 + 0.25 * (i % 5), z + size}});
    }
  }
  return crates;
}

class UpdatedBake : public ::testing::Test {
 protected:
  std::vector<std::string> bake(const std::string& scene, const std::string& output,
                                const std::vector<std::string>& more = {}) const {
    return joined({"bake", folder_.file(scene), "-o", folder_.file(output), "--depth", depth_,
                   "--triangle-budget", "100", "--near-distance", "0.05"},
                  more);
  }

  // Bakes and returns the report.
  json report(const std::vector<std::string>& arguments) const { return toolJson(arguments); }

  void bakeFirst(const std::vector<std::string>& more = {}) {
    folder_.write("first.obj", objOf(rooms()));
    std::vector<Crate> moved = rooms();
    moved.back().low[0] -= 0.5;
    moved.back().high[0] -= 0.5;
    folder_.write("moved.obj", objOf(moved));
    const Outcome outcome = runTool(bake("first.obj", "first.sight", joined({"--answers"}, more)));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }

  // Expects that an update of this file is refused with one line that says so much, and writes nothing.
  void expectRefused(const std::string& file, const std::string& about,
                     const std::vector<std::string>& more = {}) {
    const std::size_t before = folder_.entries();
    const Outcome outcome =
        runTool(bake("moved.obj", "new.sight", joined({"--update", folder_.file(file)}, more)));
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(about), std::string::npos) << outcome.err;
    EXPECT_EQ(folder_.entries(), before);
  }

  TemporaryFolder folder_;
  std::string depth_ = "4";
};

TEST_F(UpdatedBake, HasTheBytesOfAFullBake) {
  for (const std::vector<std::string>& settings :
       std::vector<std::vector<std::string>>{{}, {"--occlusion", "fused", "--narrowings", "1"}}) {
    std::vector<std::string> own = settings;
    depth_ = own.empty() ? "4" : "3";
    bakeFirst(own);
    std::vector<Crate> crates = rooms();
    std::string before = "first.sight";
    const std::vector<std::function<void()>> edits{
        [&] { crates.back().low[2] -= 0.5, crates.back().high[2] -= 0.5; },
        [&] { crates.erase(crates.begin() + 12); },
        [&] {
          crates.push_back({{7, 0, 2}, {7.5, 2.5, 5}});
        },
        [&] { crates[7].low[2] = 4; },  // closes the door
        [&] {}};
    // Other settings mean the same to the command; what they change is tested where a bake is updated.
    for (std::size_t i = 0; i < (own.empty() ? edits.size() : 1); ++i) {
      edits[i]();
      const std::string scene = "edit" + std::to_string(i) + ".obj",
                        file = "edit" + std::to_string(i) + ".sight";
      folder_.write(scene, objOf(crates));
      const std::vector<std::string> update =
          joined(own, {"--update", folder_.file(before), "--threads", "2"});
      const json made = report(bake(scene, file, update));
      if (i < 4) {  // the last edit leaves all as it is
        ASSERT_EQ(runTool(bake(scene, "full.sight", own)).code, 0);
      }
      EXPECT_TRUE(contents(folder_.file(file)) == contents(folder_.file("full.sight"))) << "edit " << i;
      EXPECT_EQ(made["update"]["difference"], "") << made;
      EXPECT_LT(made["questions_asked"], made["questions"]) << made;
      // A thing that touches others changes their outlines too.
      EXPECT_LT(made["update"]["objects_come"], i == 4 ? 1 : 4) << made;
      EXPECT_EQ(made["update"]["objects_same"].get<std::size_t>() +
                    made["update"]["objects_come"].get<std::size_t>(),
                crates.size());
      if (i == 4) {
        EXPECT_EQ(made["questions_asked"], 0);
      }
      before = file;
    }
  }
}

TEST_F(UpdatedBake, TellsWhatItDidAgain) {
  bakeFirst();
  const Outcome outcome = runTool(bake("moved.obj", "new.sight", {"--update", folder_.file("first.sight")}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("update        "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("1 gone, 1 new"), std::string::npos) << outcome.out;
  EXPECT_TRUE(std::filesystem::exists(folder_.file("new.sight.answers")));
}

TEST_F(UpdatedBake, IsTheSameWithSeveralProcesses) {
  if (!haveMpirun()) {
    GTEST_SKIP() << kNoMpirun;
  }
  bakeFirst();
  ASSERT_EQ(runTool(bake("moved.obj", "full.sight")).code, 0);
  const Outcome outcome =
      Started(toolWords(2, bake("moved.obj", "new.sight",
                                {"--update", folder_.file("first.sight"), "--json", "-"})))
          .wait();
  const json made = printedJson(outcome);
  EXPECT_TRUE(contents(folder_.file("new.sight")) == contents(folder_.file("full.sight")));
  EXPECT_LT(made["questions_asked"], made["questions"]) << made;
}

// A bake may also warn of what its sets keep.
std::ptrdiff_t linesAboutUpdate(const Outcome& outcome) {
  const std::vector<std::string> lines = tool::splitAt(outcome.err, '\n');
  return std::count_if(lines.begin(), lines.end(),
                       [](const std::string& line) { return line.starts_with("sightline: --update "); });
}

TEST_F(UpdatedBake, BakesAllAnewWithOtherSettingsOrBounds) {
  bakeFirst();
  std::vector<Crate> wider = rooms();
  wider.push_back({{30, 0, 0}, {31, 1, 1}});
  folder_.write("wider.obj", objOf(wider));
  for (const auto& [scene, more, about] :
       {std::tuple{"moved.obj", std::vector<std::string>{"--near-distance", "0.06"}, "other settings"},
        std::tuple{"wider.obj", std::vector<std::string>{}, "other bounds"}}) {
    std::vector<std::string> plain = bake(scene, "full.sight");
    std::vector<std::string> update = bake(scene, "new.sight", {"--update", folder_.file("first.sight")});
    if (!more.empty()) {
      for (std::vector<std::string>* words : {&plain, &update}) {
        *std::find(words->begin(), words->end(), "0.05") = more[1];
      }
    }
    ASSERT_EQ(runTool(plain).code, 0);
    const Outcome outcome = runTool(update);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find(about), std::string::npos) << outcome.err;
    EXPECT_EQ(linesAboutUpdate(outcome), 1) << outcome.err;
    EXPECT_TRUE(contents(folder_.file("new.sight")) == contents(folder_.file("full.sight")));
  }
}

TEST_F(UpdatedBake, SaysThatDoorsAreNotGivenAnyMore) {
  bakeFirst({"--doors", "12"});
  const std::vector<std::string> update =
      bake("moved.obj", "new.sight", {"--update", folder_.file("first.sight")});
  const Outcome without = runTool(update);
  EXPECT_EQ(without.code, 0) << without.err;
  EXPECT_NE(without.err.find("had doors"), std::string::npos) << without.err;
  EXPECT_EQ(linesAboutUpdate(without), 1) << without.err;
  const Outcome with = runTool(joined(update, {"--doors", "12"}));
  EXPECT_EQ(with.code, 0) << with.err;
  EXPECT_EQ(linesAboutUpdate(with), 0) << with.err;
}

TEST_F(UpdatedBake, GoesOnAfterItWasKilled) {
  bakeFirst();
  ASSERT_EQ(runTool(bake("moved.obj", "full.sight")).code, 0);
  const std::vector<std::string> update =
      bake("moved.obj", "new.sight", {"--update", folder_.file("first.sight"), "--resume"});
  for (int kill = 0; kill < 6; ++kill) {
    Started started(toolWords(0, update));
    usleep(20000u * static_cast<unsigned>(kill));
    started.kill(SIGKILL);
    started.wait();
    const std::string file = folder_.file("new.sight");
    if (std::filesystem::exists(file)) {
      EXPECT_TRUE(contents(file) == contents(folder_.file("full.sight")));
    }
  }
  const Outcome outcome = runTool(update);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(contents(folder_.file("new.sight")) == contents(folder_.file("full.sight")));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("new.sight.parts")));
}

TEST_F(UpdatedBake, RefusesFilesThatItCannotUse) {
  bakeFirst();
  const std::string sight = contents(folder_.file("first.sight")),
                    answers = contents(folder_.file("first.sight.answers"));
  const auto bakedFile = [&](const std::string& name, const std::string& file,
                             const std::string& of_answers) {
    folder_.write(name, file);
    folder_.write(name + ".answers", of_answers);
    return name;
  };
  expectRefused("missing.sight", "missing.sight");
  expectRefused(bakedFile("cut.sight", sight.substr(0, sight.size() / 2), answers), "cut.sight");
  expectRefused(bakedFile("not.sight", "something else", answers), "not.sight");
  folder_.write("alone.sight", sight);
  expectRefused("alone.sight", "alone.sight.answers");
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{7}, std::size_t{11}, answers.size() / 3, answers.size() - 1}) {
    expectRefused(bakedFile("short.sight", sight, answers.substr(0, length)), "short.sight.answers");
  }
  std::string altered = answers;
  altered[altered.size() / 2] = static_cast<char>(altered[altered.size() / 2] ^ 1);
  expectRefused(bakedFile("altered.sight", sight, altered), "altered");
  std::string other_version = answers;
  other_version[8] = static_cast<char>(other_version[8] + 1);
  expectRefused(bakedFile("version.sight", sight, other_version), "another version");
  ASSERT_EQ(runTool(bake("moved.obj", "other.sight", {"--answers"})).code, 0);
  expectRefused(bakedFile("mixed.sight", sight, contents(folder_.file("other.sight.answers"))),
                "of another bake");
  expectRefused("first.sight", "witnesses", {"--witnesses", folder_.file("w")});
}

TEST_F(UpdatedBake, WritesOverNoOtherFile) {
  bakeFirst();
  const std::vector<std::string> same =
      bake("moved.obj", "first.sight", {"--update", folder_.file("first.sight")});
  const std::string before = contents(folder_.file("first.sight"));
  EXPECT_EQ(runTool(same).code, 2);
  EXPECT_TRUE(contents(folder_.file("first.sight")) == before);
  folder_.write("new.sight.answers", "a letter");
  const std::vector<std::string> update =
      bake("moved.obj", "new.sight", {"--update", folder_.file("first.sight")});
  EXPECT_EQ(runTool(update).code, 2);
  EXPECT_EQ(contents(folder_.file("new.sight.answers")), "a letter");
  EXPECT_EQ(runTool(joined(update, {"--force"})).code, 0);
}

}  // namespace
}  // namespace sightline::tool_test
