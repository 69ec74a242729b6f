/* An image and its map, read from the disk. */
#ifndef STEADYSTEP_VIRTUAL_BOARD_IMAGE_FILES_H
#define STEADYSTEP_VIRTUAL_BOARD_IMAGE_FILES_H

#include <memory>
#include <string>

#include "sil/virtual_board/elf_image.h"
#include "sil/virtual_board/image_map.h"

namespace virtual_board
{

struct ImageFiles {
    ElfImage elf;
    ImageMap map;
};

/* What one run after the other asks for is read once, as long as the files stay what they are; from
   any thread. Throws std::invalid_argument as ElfImage::read and ImageMap::read. */
std::shared_ptr<const ImageFiles> read_image(const std::string &image_file);

} // namespace virtual_board

#endif
