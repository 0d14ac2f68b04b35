/* The black box's reader on an image of any bytes, and its recorder on any frames after any image. */
#include "hal/storage/black_box_reader.h"
#include "hal/storage/black_box.h"
#include "tests/proof/arbitrary.h"

/*@ assigns bytes[0 .. length - 1] \from any_u8;
    ensures \initialized(bytes + (0 .. length - 1)); */
extern void fill(uint8_t *bytes, size_t length);

static struct black_box box;

void proof_black_box_reader(void)
{
    static struct black_box_reader reader;
    fill((uint8_t *)&box, sizeof box);
    (void)black_box_reader_open(&reader, &box);
    while (black_box_reader_next(&reader) != BLACK_BOX_END) {
        //@ assert length: reader.message.length <= CAN_FRAME_DATA_MAX;
    }
}
