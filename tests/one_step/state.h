/* Values of a drive as numbers in double, whatever the format of its image. */
#ifndef STEADYSTEP_ONE_STEP_STATE_H
#define STEADYSTEP_ONE_STEP_STATE_H

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "tests/one_step/layout.h"

namespace one_step
{

/* A drive's memory: of the image that is tested, or of that in double. */
struct Memory {
    const unsigned char *at;
    const unsigned char *home; /* where the drive itself is, of a copy of it */
    bool is_double;
};

class State
{
  public:
    State(const Layout &layout, bool fixed);

    /* By what a gain of fixed point is multiplied in the format (NUM_CODE_SCALE, NUM_COUNT_SCALE):
       from what both images have made of the same settings or state. Those of before are forgotten.
     */
    void begin(Memory tested, Memory in_double);
    /* The same of gains that were zero until now. */
    void compare_gains(Memory tested, Memory in_double);

    bool in_use(const Field &field, const unsigned char *tested) const;
    /* A num, unit, coef or real. */
    double number(const Field &field, Memory memory) const;
    /* A position, an angle or an integer; goes round as it does. */
    std::int64_t whole(const Field &field, Memory memory) const;
    /* Of a pointer: the offset of what it points to in the image that is tested; npos: elsewhere.
     */
    std::size_t target(const Field &field, Memory memory) const;

    /* From the image that is tested to that in double, exactly. */
    void copy(const Block &block, Memory tested, unsigned char *in_double) const;

    bool fixed() const
    {
        return fixed_;
    }

  private:
    void copy(const Field &field, Memory tested, unsigned char *in_double) const;

    const Layout &layout_;
    const bool fixed_;
    std::vector<double> scale_;                    /* of a field that is a gain */
    std::vector<std::size_t> unknown_;             /* of which it is not known yet */
    std::map<std::size_t, std::size_t> backwards_; /* targets */
};

} // namespace one_step

#endif
