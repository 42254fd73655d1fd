/* The smallest client in C: types made by lcm-gen, nothing else of Tumble. Pushes body 1 upwards, waits for the answer
 * and prints where the body is then.
 *
 *   lcm-gen --c --c-cpath gen --c-hpath gen protocol/ack_t.lcm protocol/force_command_t.lcm protocol/state_t.lcm
 *   cc -Igen -o push clients/c/push.c gen/tumble_*.c -llcm && ./push [BODY [GENERATION]]
 */
#include <lcm/lcm.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "tumble_ack_t.h"
#include "tumble_force_command_t.h"
#include "tumble_state_t.h"

struct Run {
  tumble_force_command_t command;
  int64_t applied; /* step, or -1 */
  int shown;
};

static void on_ack(const lcm_recv_buf_t* buffer, const char* channel, const tumble_ack_t* message, void* user) {
  struct Run* run = user;
  (void)buffer, (void)channel;
  for (int i = 0; i < message->n; ++i) {
    if (message->client[i] != run->command.client || message->sequence[i] != run->command.sequence) continue;
    if (message->status[i] != 0) {
      fprintf(stderr, "refused: %s\n", message->detail[i]);
      exit(1);
    }
    run->applied = message->applied_step[i];
  }
}

static void on_state(const lcm_recv_buf_t* buffer, const char* channel, const tumble_state_t* message, void* user) {
  struct Run* run = user;
  (void)buffer, (void)channel;
  for (int i = 0; run->applied >= 0 && message->step > run->applied && i < message->n; ++i) {
    if (message->id[i] != run->command.body) continue;
    printf("step %lld: z = %.6f m, vz = %.6f m/s\n", (long long)message->step, message->pz[i], message->vz[i]);
    run->shown = 1;
  }
}

int main(int argc, char** argv) {
  struct Run run = {.applied = -1};
  lcm_t* lcm = lcm_create(NULL);
  if (!lcm) return 1;
  tumble_ack_t_subscribe(lcm, "TUMBLE_ACK", on_ack, &run);
  tumble_state_t_subscription_set_queue_capacity(tumble_state_t_subscribe(lcm, "TUMBLE_STATE", on_state, &run), 1000);
  run.command.client = (int64_t)time(NULL) << 22 | getpid(); /* one that nobody else has */
  run.command.sequence = 1;
  run.command.body = argc > 1 ? atoi(argv[1]) : 1;
  run.command.generation = argc > 2 ? atoi(argv[2]) : 1;
  run.command.force[2] = 50.0;
  run.command.duration = 0.5;
  for (int tries = 0; tries < 100 && !run.shown; ++tries) {
    if (run.applied < 0) tumble_force_command_t_publish(lcm, "TUMBLE_FORCE", &run.command); /* until it is answered */
    for (int i = 0; i < 50 && !run.shown && lcm_handle_timeout(lcm, 50) > 0; ++i) {
    }
  }
  lcm_destroy(lcm);
  return run.shown ? 0 : 1;
}
