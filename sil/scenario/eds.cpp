/* The object dictionary as an electronic data sheet, CiA 306. */
#include "sil/scenario/eds.h"

#include <map>
#include <vector>

#include "firmware/interface/dictionary.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

/* Types of CiA 301. */
enum Type {
    boolean = 0x01,
    integer32 = 0x04,
    unsigned8 = 0x05,
    unsigned16 = 0x06,
    unsigned32 = 0x07,
    real64 = 0x11
};

struct Object {
    std::string name;
    Type type = real64;
    const char *access = "ro";
    std::string preset, least, most; /* empty: not fixed */
};

using Objects = std::map<unsigned, Object>;

std::string fixed(double value, unsigned base)
{
    return base == SETTING_FIXED ? shortest(value) : "";
}

void add_settings(Objects &objects)
{
    const Type types[] = {unsigned8, boolean, real64, integer32}; /* of enum setting_type */
    const setting *row = nullptr;
    for (std::size_t i = 0; (row = setting_number(i)) != nullptr; ++i) {
        for (unsigned n = 0; n < row->count; ++n) {
            const std::string number = row->count > 1 ? format("[%u]", n + 1) : "";
            objects[row->index + n] = {
                row->name + number,
                types[row->type],
                "rw",
                setting_is_of_motor(row) ? "" : fixed(row->preset, row->preset_base),
                fixed(row->least, row->least_base),
                fixed(row->most, row->most_base)};
        }
    }
}

void add_commands(Objects &objects)
{
    objects[0x2200] = {"command", unsigned8, "wo", "", "1", std::to_string(DRIVE_COMMANDS)};
    for (int i = 0; i < DRIVE_PARAMETERS; ++i) {
        const struct parameter_row &row = *parameter_at(static_cast<drive_parameter>(i));
        objects[row.index] = {row.name, real64, "rw", "", shortest(row.least), shortest(row.most)};
    }
}

void add_signals(Objects &objects)
{
    for (int i = 0; i < SIGNALS; ++i) {
        const signal_row &row = *signal_at(static_cast<drive_signal>(i));
        const Type type = i == SIGNAL_fault          ? unsigned16
                          : row.type == SIGNAL_FLAG  ? boolean
                          : row.type == SIGNAL_COUNT ? unsigned32
                          : row.type == SIGNAL_REAL  ? real64
                                                     : unsigned8;
        objects[signal_text(static_cast<drive_signal>(i))->index] = {row.name, type, "ro",
                                                                     "",       "",   ""};
    }
}

std::string section(const std::string &name, const Object &object)
{
    std::string text = "\n[" + name + "]\nParameterName=" + object.name +
                       "\nObjectType=0x7\nDataType=" + format("0x%04x", unsigned(object.type)) +
                       "\nAccessType=" + object.access + "\nPDOMapping=0\n";
    const auto add = [&](const char *key, const std::string &value) {
        text += value.empty() ? "" : std::string(key) + "=" + value + "\n";
    };
    add("DefaultValue", object.preset);
    add("LowLimit", object.least);
    add("HighLimit", object.most);
    return text;
}

std::string list_of(const char *name, const std::vector<unsigned> &indexes)
{
    std::string text =
        "\n[" + std::string(name) + "]\nSupportedObjects=" + std::to_string(indexes.size()) + "\n";
    for (std::size_t i = 0; i < indexes.size(); ++i) {
        text += std::to_string(i + 1) + format("=0x%04x\n", indexes[i]);
    }
    return text;
}

constexpr const char *head = R"([FileInfo]
FileName=steadystep.eds
FileVersion=1
FileRevision=0
EDSVersion=4.0
Description=Written by steadystep-sil eds from the tables of firmware/interface
CreationTime=12:00AM
CreationDate=01-01-2026
CreatedBy=steadystep-sil
ModificationTime=12:00AM
ModificationDate=01-01-2026
ModifiedBy=steadystep-sil

[DeviceInfo]
VendorName=steadystep
VendorNumber=0x00000000
ProductName=steadystep
ProductNumber=0x00000000
RevisionNumber=0x00000000
OrderCode=steadystep
BaudRate_10=0
BaudRate_20=0
BaudRate_50=0
BaudRate_125=0
BaudRate_250=0
BaudRate_500=0
BaudRate_800=0
BaudRate_1000=0
SimpleBootUpMaster=0
SimpleBootUpSlave=0
Granularity=0
DynamicChannelsSupported=0
GroupMessaging=0
NrOfRXPDO=0
NrOfTXPDO=0
LSS_Supported=0

[DummyUsage]
Dummy0001=0
Dummy0002=0
Dummy0003=0
Dummy0004=0
Dummy0005=0
Dummy0006=0
Dummy0007=0

[Comments]
Lines=1
Line1=No board has a fieldbus yet: these are the numbers that one would use.
)";

constexpr const char *identity = R"(
[1018]
ParameterName=Identity object
ObjectType=0x9
SubNumber=2
)";

} // namespace

std::string electronic_data_sheet()
{
    Objects objects;
    add_settings(objects);
    add_commands(objects);
    add_signals(objects);

    std::vector<unsigned> standard, own;
    std::string text;
    for (const auto &[index, object] : objects) {
        (index >= 0x6000 ? standard : own).push_back(index);
        text += section(format("%04X", index), object);
    }
    return std::string(head) + list_of("MandatoryObjects", {0x1000, 0x1001, 0x1018}) +
           section("1000", {"Device type", unsigned32, "ro", "0x00000000", "", ""}) +
           section("1001", {"Error register", unsigned8, "ro", "0x00", "", ""}) + identity +
           section("1018sub0", {"Highest sub-index supported", unsigned8, "ro", "1", "", ""}) +
           section("1018sub1", {"Vendor-ID", unsigned32, "ro", "0x00000000", "", ""}) +
           list_of("OptionalObjects", standard) + list_of("ManufacturerObjects", own) + text;
}

} // namespace scenario
