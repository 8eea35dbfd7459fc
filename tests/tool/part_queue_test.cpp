// Who bakes which part next: neighbours stay together, and nobody waits while there is something to do.

#include "tools/sightline/bake/part_queue.h"

#include <gtest/gtest.h>

namespace sightline::tool {
namespace {

std::vector<std::uint64_t> idsOf(const std::vector<PartTask>& parts) {
  std::vector<std::uint64_t> ids;
  for (const PartTask& part : parts) {
    ids.push_back(part.id);
  }
  return ids;
}

TEST(PartQueue, GivesATakerItsOwnPartsFirstTheLastAddedOnesInTheirOrder) {
  PartQueue queue(2);
  queue.add(0, std::vector<PartTask>{{8}, {9}, {10}});
  queue.add(1, std::vector<PartTask>{{11}});
  EXPECT_EQ(queue.take(0)->id, 8u);
  queue.add(0, std::vector<PartTask>{{64}, {65}});
  EXPECT_EQ(idsOf(queue.takeNow(0, 3)), (std::vector<std::uint64_t>{64, 65, 9}));
}

TEST(PartQueue, GivesTheLargestPartOfAnotherToWhoHasNone) {
  PartQueue queue(3);
  queue.add(0, std::vector<PartTask>{{9}, {10}});
  queue.add(0, std::vector<PartTask>{{64}, {65}});
  queue.add(1, std::vector<PartTask>{{600}});
  EXPECT_EQ(queue.waiting(), 5u);
  EXPECT_EQ(queue.take(2)->id, 10u);
  EXPECT_EQ(queue.take(2)->id, 9u);
  EXPECT_EQ(queue.waiting(), 3u);
  EXPECT_EQ(idsOf(queue.takeNow(2, 9)), (std::vector<std::uint64_t>{65, 64, 600}));
}

TEST(PartQueue, GivesWhatIsLeftWhenClosedAndNothingWhenCleared) {
  PartQueue queue(1);
  queue.add(0, std::vector<PartTask>{{8}, {9}});
  queue.close();
  EXPECT_EQ(queue.take(0)->id, 8u);
  queue.clear();
  queue.add(0, std::vector<PartTask>{{72}});
  EXPECT_FALSE(queue.take(0)) << "what a part was divided into when the bake had failed";
}

}  // namespace
}  // namespace sightline::tool
