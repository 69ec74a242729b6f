#include "sil/scenario/number_formats.h"

#include <algorithm>
#include <array>

namespace scenario
{

namespace
{

const std::array images{&firmware_image_float, &firmware_image_fixed, &firmware_image_double,
                        &firmware_image_one_motor};

} // namespace

const std::vector<std::string> &number_formats()
{
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const firmware_image *image : images) {
            list.emplace_back(image->numeric);
        }
        return list;
    }();
    return names;
}

const firmware_image *image_of(const std::string &numeric)
{
    const auto image = std::find_if(images.begin(), images.end(), [&](const firmware_image *one) {
        return numeric == one->numeric;
    });
    return image == images.end() ? nullptr : *image;
}

} // namespace scenario
