// The inlined sine and cosine beside the library's.
#include "terrain/math/sincos.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

TEST(SinCos, agrees_with_the_library_to_the_error_it_states)
{
    testing::Numbers random(3);
    for (int i = 0; i < 200000; ++i) {
        const double size = i % 2 ? 1e4 : 1e5, angle = random.between(-size, size);
        const SinCos at = sin_cos(angle);
        ASSERT_NEAR(at.sine, std::sin(angle), size > 5e4 ? 1e-15 : 3e-16) << angle;
        ASSERT_NEAR(at.cosine, std::cos(angle), size > 5e4 ? 1e-15 : 3e-16) << angle;
    }
    EXPECT_EQ(sin_cos(0.0).sine, 0.0);
    EXPECT_EQ(sin_cos(0.0).cosine, 1.0);
}

}  // namespace
}  // namespace hoodoo
