/* Runs numbered pieces of work on all cores.
 *
 * Nobody knows which thread does which piece. A piece's result must depend on its number alone; then the whole
 * does not depend on the number of threads.
 */
#ifndef SIM_HOST_BATCH_PARALLEL_FOR_H
#define SIM_HOST_BATCH_PARALLEL_FOR_H

#include <stddef.h>

/* Does one piece. Called from several threads, once per piece. Returns 0 to go on; else no new pieces are begun. */
typedef int piece_fn(void *context, size_t piece);

/* Threads that `threads` asks for: itself when > 0, else the number of cores this process may use. */
int parallel_for_threads(int threads);

/* Calls piece(context, 0 .. pieces-1), in rising order of begin, on `threads` threads (0: one per core), the
 * calling one among them. A thread that cannot be started is done without.
 * Returns 0, or the first non-zero value a piece returned; all pieces begun have ended then. */
int parallel_for(int threads, size_t pieces, piece_fn *piece, void *context);

#endif
