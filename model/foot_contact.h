/* What a foot switch says, whatever protocol brings it: hal/ fills it in, controller/ decides by it.
 *
 * A switch under heel or toe, or a channel of an insole. It is optional hardware. The values appear on
 * the bus and in logs: they never change meaning.
 */
#ifndef MODEL_FOOT_CONTACT_H
#define MODEL_FOOT_CONTACT_H

enum foot_contact {
    FOOT_UNKNOWN = 0, /* no switch, none heard, or it reports a fault of its own */
    FOOT_UP = 1,
    FOOT_DOWN = 2
};

#endif
