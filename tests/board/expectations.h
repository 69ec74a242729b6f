/* What is expected of a run of an image, reported one by one and counted. */
#ifndef STEADYSTEP_TESTS_BOARD_EXPECTATIONS_H
#define STEADYSTEP_TESTS_BOARD_EXPECTATIONS_H

#include <cstddef>
#include <cstdio>
#include <string>

class Expectations
{
  public:
    void expect(bool held, const std::string &what)
    {
        std::printf("%-76s %s\n", what.c_str(), held ? "held" : "NOT HELD");
        failures_ += held ? 0 : 1;
    }
    int failures() const
    {
        return failures_;
    }

  private:
    int failures_ = 0;
};

/* How often a part occurs in what the board has written. */
inline std::size_t count(const std::string &text, const std::string &part)
{
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        found++;
    }
    return found;
}

#endif
