/* Where scenarios, sweeps, motors and parameter sets are found by name. */
#ifndef STEADYSTEP_SCENARIO_CATALOGUE_H
#define STEADYSTEP_SCENARIO_CATALOGUE_H

#include <filesystem>
#include <string>
#include <vector>

namespace scenario
{

/* With '/' in it or ending in .toml; else a name. */
bool is_path(const std::string &name);

class Catalogue
{
  public:
    /*
     * The folder of scenarios is, in this order: `scenarios` if not empty, "scenarios" beside the
     * program, the source tree. Motors lie in "../motors" from there, parameter sets in
     * "../parameters", or else where the program's own are.
     */
    Catalogue(const std::filesystem::path &scenarios, const std::filesystem::path &program);

    /* A path (with '/' or ending in .toml) or a name in the catalogue; throws InputError, with
       `asked_by` as the place of the complaint. A path is relative to `folder`. */
    std::filesystem::path scenario(const std::string &name, const std::string &asked_by,
                                   const std::filesystem::path &folder = {}) const;
    std::filesystem::path sweep(const std::string &name, const std::string &asked_by) const;
    std::filesystem::path motor(const std::string &name, const std::string &asked_by,
                                const std::filesystem::path &folder) const;
    /* A set's name is "motor/law"; only what ends in .toml is a path. */
    std::filesystem::path parameters(const std::string &name, const std::string &asked_by,
                                     const std::filesystem::path &folder) const;

    std::vector<std::filesystem::path> scenarios() const; /* sorted by name */
    std::vector<std::filesystem::path> motors() const;
    std::vector<std::filesystem::path> sweeps() const;
    std::vector<std::filesystem::path> parameters() const; /* by motor, then by law */

  private:
    std::filesystem::path scenarios_;
    std::vector<std::filesystem::path> motors_, parameters_; /* first match wins */
};

} // namespace scenario

#endif
