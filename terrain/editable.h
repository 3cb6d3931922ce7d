// A surface that stays alive while its layers are edited: what an editor holds between strokes.
#pragma once

#include "terrain/schema.h"
#include "terrain/shape.h"

#include <string>
#include <vector>

namespace hoodoo
{

class ColumnSet;

/// What an edit made anew.
struct Rebuilt {
    std::vector<std::uint32_t> tiles;  ///< ascending
    InstanceChange rocks = InstanceChange::none;
};

/// Edit, then rebuild with the columns that changed, then Tracer::update with what rebuild returns; none of the three while other threads trace.
class EditableSurface : public Surface
{
public:
    /// Whether edit() may be called: a row of the catalogue that was told so (BuildContext::editable). Else the owner of the stack changes it in
    /// place (edit/tools.h).
    virtual bool takes_edits() const = 0;

    /// Applies `tool` with the parameters of an [[edit]] table as the next one of the terrain. Returns the columns that may differ afterwards.
    /// Throws Error (scene) with all problems of the table: the layers are then as they were.
    virtual ColumnSet edit(const std::string& tool, const Node& parameters) = 0;

    /// Makes the tiles that read these columns anew, and places the rocks about them, exactly as a new surface would. Its cost follows the
    /// columns, but for water and for a copy of the list of rocks. Throws Error (scene) if there are too many rocks now, after all else.
    virtual Rebuilt rebuild(const ColumnSet& changed) = 0;

    /// Space that edits can come to fill, metres.
    virtual Box3d room() const = 0;
};

}  // namespace hoodoo
