package android.os;

import java.util.concurrent.ScheduledThreadPoolExecutor;

/** A stand-in: one thread is the main thread. */
public class Handler {
    public static final ScheduledThreadPoolExecutor MAIN = new ScheduledThreadPoolExecutor(1, code -> {
        final Thread thread = new Thread(code, "main-looper");
        thread.setDaemon(true);
        return thread;
    });

    public Handler(Looper looper) {
    }

    public final boolean post(Runnable call) {
        MAIN.execute(call);
        return true;
    }
}
