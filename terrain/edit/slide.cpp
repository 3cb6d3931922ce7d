// One move of the stabilisation: the excess of every neighbour's head over what repose bears, divided so that the step shrinks and never turns round.
// Peytavie2009, section 3.4: E_i = max(0, dh_i - d_i tan(alpha)), and dz_i is proportional to E_i. The sign of dh and the distance d_i (s or s sqrt
// 2) follow their sense, not the misprints. Deviations: the paper moves a small constant; with k neighbours in excess, E_i / (k + 1) each is what
// levels them at once if all are alike, which takes far fewer moves. An excess counts up to one threshold, so that a tower crumbles instead of
// bursting: its pile then stands at the angle of repose up to the last two columns of its top, and not 10% flatter. Why every move lowers the
// potential energy. Layers of one kind have the energy sum (top^2 - bottom^2) / 2 over the pockets; moving shares q_i of the sum q from height h to
// surfaces h_i, with h - h_i >= head_i, changes it by  sum q_i^2 / 2 + q^2 / 2 - sum q_i (h - h_i). Let q_i <= head_i / (k + 1). By Cauchy q^2 <= k
// sum q_i^2, so the first two terms are at most (k + 1) / 2 sum q_i^2 <= sum q_i head_i / 2: less than what the last one takes. When all shares round
// to nothing one unit moves: 1/2 + 1/2 - head < 0, since head >= 2. Twice the energy is an integer and not negative: only finitely many moves can
// follow one another.
#include "terrain/edit/slide.h"

#include <algorithm>

namespace hoodoo
{

std::int32_t share_out(std::span<Target> targets, std::int32_t thickness)
{
    const auto excess = [](const Target& t) { return t.threshold > 0.0 ? std::min(t.head - t.threshold, t.threshold) : t.head; };
    const double parts = static_cast<double>(targets.size()) + 1.0;
    std::int64_t sum = 0;
    for (Target& t : targets) {
        t.share = std::min(static_cast<std::int32_t>(excess(t) / parts), t.room);
        sum += t.share;
    }
    if (sum > thickness) {
        // Too little for all: everyone's share shrinks alike.
        const std::int64_t wanted = sum;
        sum = 0;
        for (Target& t : targets) {
            t.share = static_cast<std::int32_t>(t.share * static_cast<std::int64_t>(thickness) / wanted);
            sum += t.share;
        }
    }
    if (sum > 0) return static_cast<std::int32_t>(sum);
    Target& most = *std::max_element(targets.begin(), targets.end(), [&](const Target& a, const Target& b) { return excess(a) < excess(b); });
    most.share = 1;
    return 1;
}

}  // namespace hoodoo
