#include "sil/plant/belt.h"

#include "sil/plant/elementary.h"
#include "sil/plant/require.h"

namespace plant
{

Belt belt_of(const BeltConfig &config, double inertia_kgm2)
{
    const double share = config.inertia_share;
    require(share >= 0.0 && share <= 0.99, "belt_inertia_share", share, "0 (no belt)...0.99");
    require(config.frequency_Hz >= 1.0 && config.frequency_Hz <= 2000.0, "belt_frequency_Hz",
            config.frequency_Hz, "1...2000 Hz");
    require(config.damping >= 0.0 && config.damping <= 1.0, "belt_damping", config.damping,
            "0...1");
    if (share == 0.0) {
        return {};
    }
    const double rate = 2.0 * pi * config.frequency_Hz;
    const double reduced_kgm2 = inertia_kgm2 * share * (1.0 - share);
    return {share, reduced_kgm2 * rate * rate, 2.0 * config.damping * rate * reduced_kgm2};
}

} // namespace plant
