#include "sil/virtual_board/image_files.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <utility>

namespace virtual_board
{

std::shared_ptr<const ImageFiles> read_image(const std::string &image_file)
{
    namespace fs = std::filesystem;
    struct State {
        std::string file;
        std::array<fs::file_time_type, 2> written;
        std::array<std::uintmax_t, 2> bytes;

        bool operator==(const State &other) const
        {
            return file == other.file && written == other.written && bytes == other.bytes;
        }
    };
    static std::mutex one_at_a_time; /* runs have a thread each */
    static State last_state;
    static std::shared_ptr<const ImageFiles> last;

    const std::lock_guard<std::mutex> lock(one_at_a_time);
    const std::string map_file = map_file_of(image_file);
    std::error_code none; /* a file that is not there is reported by who reads it */
    const State state = {
        image_file,
        {fs::last_write_time(image_file, none), fs::last_write_time(map_file, none)},
        {fs::file_size(image_file, none), fs::file_size(map_file, none)}};
    if (!last || !(state == last_state)) {
        last.reset();
        ElfImage elf = ElfImage::read(image_file);
        ImageMap map = ImageMap::read(map_file, elf);
        last = std::make_shared<const ImageFiles>(ImageFiles{std::move(elf), std::move(map)});
        last_state = state;
    }
    return last;
}

} // namespace virtual_board
