// What every edit promises, as functions with a verdict.
#pragma once

#include "terrain/edit/tools.h"
#include "tests/support/surface_laws.h"

#include <functional>

namespace hoodoo::testing
{

/// The law of rest, written down from its words and not from the code: heights on a lattice, whole columns of letters, brute force. Of every material
/// and every pocket, no opening to a neighbour's pocket with room has a head over d tan(alpha) + 1 unit.
bool at_rest(const MaterialStack& stack, const Repose& repose, std::string* why = nullptr);

/// How an edit is done: `entries` without their `tool`.
using EditRunner = std::function<ColumnSet(MaterialStack&, const char* tool, const Node& entries, std::size_t number)>;

/// `count` random edits after one another, by all tools, on a stack that rests. Columns that an edit does not name keep their bits, with
/// stabilisation and without; stabilisation conserves the mass of every material, erosion that of what is solid, a deposit all but what it lays down;
/// an edit that is refused leaves everything as it was; and every `rests`-th time the whole terrain is at rest.
Verdict edits_keep_their_promises(const MaterialStack& begin, const EditRunner& run, std::uint64_t seed, int count, int rests);

}  // namespace hoodoo::testing
