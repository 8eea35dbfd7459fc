#include "occluders/packed_lists.h"

#include <gtest/gtest.h>
