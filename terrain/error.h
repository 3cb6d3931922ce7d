// The one exception: where, what, what was expected, what was found, the nearest valid name. Thrown only before the first ray.
#pragma once

#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace hoodoo
{

/// A position in a scene file (or in a text given by a host, whose `file` is then "<text>"). Lines and columns start at 1; 0 = unknown.
/// `excerpt` is the line itself, so that a message can show it after the text is gone.
struct Source {
    std::string file;
    int line = 0;
    int column = 0;
    std::string excerpt;
};

/// The numbers are the exit codes of the command line.
enum class ErrorKind { internal = 1, scene = 2, file = 3, memory = 4 };

/// One thing that is wrong. Only `what` is always present; `expected`, `got`, `nearest` are left empty where they say nothing.
struct Problem {
    Source where;
    std::string what;
    std::string expected;
    std::string got;
    std::string nearest;

    /// `file:line:column: what, expected ..., got ... (did you mean "...")`, then the excerpt and a caret where known.
    std::string text() const;
};

/// All problems of one file at once. what() is their texts, one after another.
class Error : public std::exception
{
public:
    Error(ErrorKind kind, std::vector<Problem> problems);
    Error(ErrorKind kind, Problem problem) : Error(kind, std::vector<Problem>{std::move(problem)}) {}
    /// A problem that has no position, such as a full disk.
    Error(ErrorKind kind, std::string what) : Error(kind, Problem{{}, std::move(what), {}, {}, {}}) {}

    ErrorKind kind() const { return kind_; }
    const std::vector<Problem>& problems() const { return problems_; }
    const char* what() const noexcept override { return text_.c_str(); }

private:
    ErrorKind kind_;
    std::vector<Problem> problems_;
    std::string text_;
};

/// The member of `names` with the smallest edit distance to `name`, or "" if none is near (more than a third of its letters differ).
std::string nearest_name(const std::string& name, const std::vector<std::string>& names);

}  // namespace hoodoo
