// A scene file and what it includes, merged into one tree.
#pragma once

#include "renderer/scene/files.h"
#include "renderer/scene/toml_text.h"

#include <string>
#include <vector>

namespace hoodoo
{

/// Reads, includes, merges. The including file wins over its includes, a later include over an earlier one; tables merge, all else is replaced.
class SceneLoader
{
public:
    SceneLoader(SceneFiles& files, SceneBudget& budget, std::vector<Problem>& problems) : files_(files), budget_(budget), problems_(problems) {}

    Node load_text(const std::string& text);
    Node load_file(const std::string& path);  ///< its folder becomes a root

    /// Whether a file was absent or unreadable, and nothing else was wrong so far.
    bool only_files_missing() const { return missing_ > 0 && missing_ == problems_.size(); }

private:
    Node parse(const std::string& text, const std::string& file);
    void include(Node& root, const std::string& file);
    Node included(const std::string& path, const Source& where, const std::string& file);

    SceneFiles& files_;
    SceneBudget& budget_;
    std::vector<Problem>& problems_;
    std::vector<std::string> open_;  ///< real paths of the files being read, outermost first
    std::size_t missing_ = 0;
};

}  // namespace hoodoo
