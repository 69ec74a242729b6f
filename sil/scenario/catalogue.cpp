#include "sil/scenario/catalogue.h"

#include <algorithm>

#include "sil/scenario/document.h"
#include "sil/scenario/table_reader.h"

#ifndef STEADYSTEP_SIL_SOURCE_DIR
#error "STEADYSTEP_SIL_SOURCE_DIR: folder that holds scenarios/ and motors/"
#endif

namespace scenario
{

namespace fs = std::filesystem;

namespace
{

bool is_path(const std::string &name)
{
    return name.find('/') != std::string::npos || fs::path(name).extension() == ".toml";
}

std::vector<fs::path> toml_files(const fs::path &folder)
{
    std::vector<fs::path> files;
    std::error_code error;
    for (const fs::directory_entry &entry : fs::directory_iterator(folder, error)) {
        if (entry.path().extension() == ".toml") {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end(),
              [](const fs::path &a, const fs::path &b) { return a.stem() < b.stem(); });
    return files;
}

/* The file of `name` in the first folder that has it. */
fs::path look_up(const char *what, const std::string &name, const std::string &asked_by,
                 const std::vector<fs::path> &folders)
{
    std::vector<std::string> known;
    for (const fs::path &folder : folders) {
        for (const fs::path &file : toml_files(folder)) {
            if (file.stem() == name) {
                return file;
            }
            known.push_back(file.stem().string());
        }
    }
    const std::string guess = nearest(name, known);
    throw InputError(asked_by + ": unknown " + what + " \"" + name + "\", expected a path or " +
                     (guess.empty() ? "a name that `steadystep-sil list` shows"
                                    : "a known name (did you mean " + guess + "?)"));
}

} // namespace

Catalogue::Catalogue(const fs::path &scenarios, const fs::path &program)
{
    const fs::path source = STEADYSTEP_SIL_SOURCE_DIR;
    const fs::path beside = program.parent_path();
    std::error_code error;
    const bool installed = fs::is_directory(beside / "scenarios", error);

    scenarios_ = !scenarios.empty() ? scenarios
                 : installed        ? beside / "scenarios"
                                    : source / "scenarios";
    if (!fs::is_directory(scenarios_, error)) {
        throw InputError(scenarios_.string() + ": no such folder of scenarios");
    }
    motors_ = {scenarios_ / ".." / "motors", installed ? beside / "motors" : source / "motors"};
    if (fs::equivalent(motors_[0], motors_[1], error)) {
        motors_ = {installed ? beside / "motors" : source / "motors"};
    }
}

fs::path Catalogue::scenario(const std::string &name, const std::string &asked_by,
                             const fs::path &folder) const
{
    return is_path(name) ? folder / name : look_up("scenario", name, asked_by, {scenarios_});
}

fs::path Catalogue::sweep(const std::string &name, const std::string &asked_by) const
{
    return is_path(name) ? fs::path(name)
                         : look_up("sweep", name, asked_by, {scenarios_ / "sweeps"});
}

fs::path Catalogue::motor(const std::string &name, const std::string &asked_by,
                          const fs::path &folder) const
{
    return is_path(name) ? folder / name : look_up("motor", name, asked_by, motors_);
}

std::vector<fs::path> Catalogue::scenarios() const
{
    return toml_files(scenarios_);
}

std::vector<fs::path> Catalogue::sweeps() const
{
    return toml_files(scenarios_ / "sweeps");
}

std::vector<fs::path> Catalogue::motors() const
{
    std::vector<fs::path> files;
    for (const fs::path &folder : motors_) {
        const std::vector<fs::path> more = toml_files(folder);
        files.insert(files.end(), more.begin(), more.end());
    }
    return files;
}

} // namespace scenario
