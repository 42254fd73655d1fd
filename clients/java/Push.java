import java.io.IOException;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import tumble.ack_t;
import tumble.force_command_t;
import tumble.state_t;

/**
 * The smallest client in Java: types made by lcm-gen, nothing else of Tumble. Pushes body 1 upwards, waits for the
 * answer and prints where the body is then.
 *
 * <pre>
 *   lcm-gen --java --jpath gen protocol/*.lcm
 *   javac -cp /usr/share/java/lcm.jar -d classes gen/tumble/*.java clients/java/Push.java
 *   java -Djava.net.preferIPv4Stack=true -cp classes:/usr/share/java/lcm.jar Push [BODY [GENERATION]]
 * </pre>
 */
public final class Push {
  private final force_command_t command = new force_command_t();
  private long applied = -1;
  private String shown;

  private synchronized void receive(LCM bus, String channel, LCMDataInputStream data) {
    try {
      if (channel.equals("TUMBLE_ACK")) {
        heed(new ack_t(data));
      } else {
        heed(new state_t(data));
      }
    } catch (IOException damaged) {
      System.err.println("not a message of ours on " + channel);
    }
  }

  private void heed(ack_t answers) {
    for (int i = 0; i < answers.n; i++) {
      if (answers.client[i] != command.client || answers.sequence[i] != command.sequence) continue;
      if (answers.status[i] != 0) {
        System.err.println("refused: " + answers.detail[i]);
        System.exit(1);
      }
      applied = answers.applied_step[i];
    }
  }

  private void heed(state_t state) {
    for (int i = 0; applied >= 0 && state.step > applied && i < state.n; i++) {
      if (state.id[i] != command.body) continue;
      shown = String.format("step %d: z = %.6f m, vz = %.6f m/s", state.step, state.pz[i], state.vz[i]);
    }
  }

  private synchronized String shown() {
    return shown;
  }

  private synchronized boolean answered() {
    return applied >= 0;
  }

  public static void main(String[] arguments) throws IOException, InterruptedException {
    Push push = new Push();
    LCM bus = new LCM();
    bus.subscribe("TUMBLE_(ACK|STATE)", push::receive);
    push.command.client = System.nanoTime() | 1;
    push.command.sequence = 1;
    push.command.body = arguments.length > 0 ? Integer.parseInt(arguments[0]) : 1;
    push.command.generation = arguments.length > 1 ? Integer.parseInt(arguments[1]) : 1;
    push.command.force[2] = 50.0;
    push.command.duration = 0.5;
    for (int tries = 0; tries < 100 && push.shown() == null; tries++) {
      if (!push.answered()) bus.publish("TUMBLE_FORCE", push.command); // until it is answered
      Thread.sleep(50);
    }
    bus.close();
    if (push.shown() == null) System.exit(1);
    System.out.println(push.shown());
  }
}
