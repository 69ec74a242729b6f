/*
 * What the build knows about an image and the image itself does not show: costs and stages of its
 * instructions, where its control interrupt runs and where the drive keeps its signals. Written by
 * tools/image_map beside the image, as <name>.map.json.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_IMAGE_MAP_H
#define STEADYSTEP_VIRTUAL_BOARD_IMAGE_MAP_H

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sil/virtual_board/elf_image.h"
#include "sil/virtual_board/instruction_costs.h"

namespace virtual_board
{

/* Where the image keeps a number. */
struct Variable {
    std::uint32_t address = 0, bytes = 0;
    std::string type; /* float, double, bool, int8...int64, uint8...uint64, pointer, enum <tag> */
};

struct ImageMap {
    std::string file;
    std::string core;           /* m4f or m0plus */
    std::string numeric;        /* float, fixed or one_motor */
    int half_period_counts = 0; /* of its PWM timer; 0: it has no board */
    std::map<std::string, Variable> signals;
    std::map<std::string, unsigned> interrupts; /* handler -> number of the exception */
    std::vector<std::uint32_t> enabling;        /* begin what the interrupt may run from flash */
    CostRules rules;
    std::vector<std::string> stages;
    struct Instruction {
        std::uint32_t address;
        InstructionCost cost;
    };
    std::vector<Instruction> code;

    /* Reads the file beside the image. Throws std::invalid_argument: no such file, not of this
       image, not of this form. */
    static ImageMap read(const std::string &file, const ElfImage &image);
    /* Reads it and gives a chip what its instructions cost. */
    static ImageMap read(const std::string &file, const ElfImage &image, InstructionCosts &costs);
    /* Throws std::invalid_argument if the chip has no memory where the map has code. */
    void give(InstructionCosts &costs) const;

    const Variable &signal(const std::string &name) const; /* throws std::invalid_argument */
};

/* steadystep.elf -> steadystep.map.json */
std::string map_file_of(const std::string &image_file);

} // namespace virtual_board

#endif
