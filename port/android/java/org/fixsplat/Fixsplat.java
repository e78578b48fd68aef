package org.fixsplat;

import android.content.res.AssetFileDescriptor;
import android.content.res.AssetManager;
import android.os.Handler;
import android.os.Looper;
import android.view.Surface;
import java.io.FileInputStream;
import java.io.IOException;
import java.nio.ByteBuffer;
import java.util.ArrayDeque;
import java.util.Objects;
import java.util.concurrent.CancellationException;
import java.util.concurrent.ExecutionException;
import java.util.concurrent.FutureTask;
import java.util.function.DoubleConsumer;

/**
 * Shows a scene in a Surface. A thread of its own draws, and draws only if something has changed. Any thread may call
 * the methods. None of them waits for a file, a network or a frame, except setSurface and close, which wait for the
 * frame in progress. After close, all other methods throw an IllegalStateException.
 */
public final class Fixsplat implements AutoCloseable {
    static {
        System.loadLibrary("fixsplat");
    }

    /** What a program may hear of. The calls come on the main thread, none after close. */
    public interface Listener {
        /** A scene was opened, and has replaced the one before. */
        default void onOpen(Fixsplat scene) {
        }

        /** The share of the work that is done, 0 to 1: first of opening a scene, then of its details. */
        default void onProgress(double done) {
        }

        /** A scene could not be opened, or a frame not be drawn. The one before stays. */
        default void onFault(FixsplatException fault) {
        }
    }

    /** The Gaussian at a pixel: its number, and the point of the scene that the pixel shows. */
    public static final class Pick {
        public final long gaussian;
        public final double depth, x, y, z;

        private Pick(double[] found) {
            gaussian = (long) found[0];
            depth = found[1];
            x = found[2];
            y = found[3];
            z = found[4];
        }
    }

    /** Gets the answer of a pick on the main thread; null: no Gaussian is there. */
    public interface OnPick {
        void onPick(Pick pick);
    }

    /** What the last frame was. */
    public static final class State {
        /** Back end: vulkan, gles-compute or gles; null: nothing was drawn. */
        public final String backEnd;
        /** Parts of the scene that the frame drew coarser, as they were not there. */
        public final int missing;
        /** Most Gaussians of the frame (0: all), and the size of its picture. */
        public final int budget, width, height;
        /** Frames that were shown, of all scenes. */
        public final long frames;

        private State(String backEnd, int[] now, long frames) {
            this.backEnd = backEnd;
            this.frames = frames;
            missing = now[0];
            budget = now[2];
            width = now[3];
            height = now[4];
        }
    }

    /** Frames without as many parts as the frame before, after which a resting view waits for parts to arrive. */
    private static final int SETTLED = 4;
    /** Milliseconds until a resting view asks again for parts that could not be read. */
    private static final int RETRY = 500;
    private final Listener listener;
    private final Handler main = new Handler(Looper.getMainLooper());
    private final Thread thread = new Thread(this::run, "fixsplat");
    private final Object lock = new Object();
    private final ArrayDeque<Runnable> jobs = new ArrayDeque<>();

    /* Under the lock. */
    private boolean isClosed, isPaused, isDirty;
    private Camera camera;
    private State state = new State(null, new int[6], 0);
    private Source opening;
    private int openings, same;

    /* Of the drawing thread. */
    private final long view;
    private long scene;
    private boolean hasSurface, hasEnded;
    private int missing, coming;
    private String told;

    /** `listener` may be null. */
    public Fixsplat(Listener listener) throws FixsplatException {
        this.listener = listener == null ? new Listener() { } : listener;
        view = create();
        pace(view, 1000000000 / 60, 1000000);
        thread.start();
    }

    /* ---- Scenes -------------------------------------------------------------------------------------------------- */

    /** Opens an asset of any format. An .fxs with levels of detail is read in parts, if it is stored without
     *  compression (noCompress). */
    public void openAsset(AssetManager assets, String name) {
        open(name, (told, awake) -> {
            final AssetFileDescriptor part;
            try {
                part = assets.openFd(name);
            } catch (IOException compressed) {
                return new Source.OfStream(name, assets.open(name), told, awake);
            }
            return new Source.OfFile(name, part, part.getFileDescriptor(), part.getStartOffset(), part.getLength(),
                                     told, awake);
        });
    }

    /** Opens a file of any format. An .fxs with levels of detail is read in parts. */
    public void openFile(String path) {
        open(path, (told, awake) -> {
            final FileInputStream file = new FileInputStream(path);
            return new Source.OfFile(path, file, file.getFD(), 0, file.getChannel().size(), told, awake);
        });
    }

    /** Opens a file of a web server that sends parts of files. A request fails if its answer takes longer than
     *  `limit` milliseconds. */
    public void openAddress(String address, int limit) {
        open(address, (told, awake) -> new Source.OfAddress(address, limit, told, awake));
    }

    /** Ends the opening of a scene that was begun last; the one before stays. */
    public void cancel() {
        post(this::stopOpening);
    }

    private interface Maker {
        Source make(DoubleConsumer told, Runnable awake) throws IOException;
    }

    private void open(String name, Maker maker) {
        post(() -> {
            final int number = stopOpening();
            new Thread(() -> load(name, maker, number), "fixsplat-open").start();
        });
    }

    /** Returns the number of the next opening. */
    private int stopOpening() {
        final Source source;
        synchronized (lock) {
            source = opening;
            opening = null;
            openings++;
        }
        if (source != null)
            source.cancel();
        return openings;
    }

    private void load(String name, Maker maker, int number) {
        Source source = null;
        long made = 0;
        try {
            source = maker.make(done -> tell(() -> listener.onProgress(done)), this::arrived);
            begin(source, number);
            made = openBest(source);
            final double[] first = new double[10];
            firstCamera(made, 1280, 720, first);
            install(made, new Camera(first), number);
        } catch (IOException | RuntimeException | OutOfMemoryError fault) {
            closeScene(made);
            if (isCurrent(number))
                fault(fault instanceof FixsplatException ? (FixsplatException) fault
                      : new FixsplatException(Source.reason(name, fault)));
            if (source != null)
                source.cancel();
        }
    }

    private void begin(Source source, int number) {
        synchronized (lock) {
            if (number != openings)
                throw new CancellationException();
            opening = source;
        }
    }

    private boolean isCurrent(int number) {
        synchronized (lock) {
            return number == openings;
        }
    }

    /** Opens a scene in parts, or else as a whole. */
    private static long openBest(Source source) throws IOException {
        if (!(source instanceof Source.OfStream))
            try {
                return open(source.name, source, null);
            } catch (FixsplatException fault) {
                if (source.isCancelled() || source.hasFailed())
                    throw fault;
            }
        final long made = open(source.name, source, source.whole());
        source.stop();
        return made;
    }

    /** Gives a scene to the drawing thread. */
    private void install(long made, Camera first, int number) {
        synchronized (lock) {
            if (isClosed || number != openings)
                throw new CancellationException();
            opening = null;
            camera = first;
            jobs.add(() -> take(made));
            isDirty = true;
            lock.notifyAll();
        }
        tell(() -> listener.onOpen(this));
    }

    private void take(long made) {
        setScene(view, made);
        closeScene(scene);
        scene = made;
    }

    /* ---- The window and the picture ------------------------------------------------------------------------------ */

    /** Draws into a surface, or into none: null. Call it again when the surface has another size. Before a surface is
     *  destroyed, call it with null. */
    public void setSurface(Surface surface) {
        final FutureTask<Void> task = new FutureTask<>(() -> {
            hasSurface = surface != null;
            awake();
            take(view, surface);
            return null;
        });
        post(task::run);
        finish(task);
    }

    /** Stops drawing, until resume. */
    public void pause() {
        setPaused(true);
    }

    public void resume() {
        setPaused(false);
    }

    private void setPaused(boolean is) {
        synchronized (lock) {
            check();
            isPaused = is;
            isDirty = true;
            lock.notifyAll();
        }
    }

    /** Returns the camera; null before a scene was opened, if none was set. */
    public Camera getCamera() {
        synchronized (lock) {
            check();
            return camera;
        }
    }

    public void setCamera(Camera camera) {
        synchronized (lock) {
            check();
            this.camera = Objects.requireNonNull(camera);
        }
        redraw();
    }

    /** Draws the picture again, although nothing has changed. */
    public void redraw() {
        synchronized (lock) {
            check();
        }
        awake();
    }

    private void awake() {
        synchronized (lock) {
            isDirty = true;
            lock.notifyAll();
        }
    }

    /** Holds a rate in frames a second, by the number of Gaussians and by the size of the picture; 0: draws every frame
     *  in full. `budget`: most Gaussians of a frame, for scenes with levels of detail; 0: all. At first 60 and a
     *  million. */
    public void setPace(double rate, int budget) {
        if (!(rate == 0 || rate >= 1 && rate <= 1000) || budget < 0)
            throw new IllegalArgumentException("a rate of " + rate + " and a budget of " + budget);
        post(() -> pace(view, rate == 0 ? 0 : (int) (1e9 / rate), budget));
        awake();
    }

    /** Gives memory back: halves the budget and the memory of the device; without a surface, closes the device. */
    public void trim() {
        post(() -> trim(view));
    }

    /** Finds the Gaussian at a pixel of the surface. */
    public void pick(int x, int y, OnPick answer) {
        post(() -> {
            final double[] found = new double[5];
            final Camera now;
            synchronized (lock) {
                now = camera;
            }
            final Pick pick = now != null && pick(view, now.numbers(), x, y, found) ? new Pick(found) : null;
            tell(() -> answer.onPick(pick));
        });
    }

    public State getState() {
        synchronized (lock) {
            check();
            return state;
        }
    }

    /** Frees everything. */
    @Override public void close() {
        final FutureTask<Void> task = new FutureTask<>(() -> {
            stopOpening();
            destroy(view);
            closeScene(scene);
            hasEnded = true;
            return null;
        });
        synchronized (lock) {
            if (isClosed)
                return;
            isClosed = true;
            jobs.add(task);
            lock.notifyAll();
        }
        finish(task);
    }

    /* ---- Threads ------------------------------------------------------------------------------------------------- */

    /** A job of the drawing thread. */
    private interface Job {
        void run() throws FixsplatException;
    }

    private void check() {
        if (isClosed)
            throw new IllegalStateException("this Fixsplat was closed");
    }

    private void post(Job job) {
        synchronized (lock) {
            check();
            jobs.add(() -> {
                try {
                    job.run();
                } catch (FixsplatException fault) {
                    fault(fault);
                } catch (RuntimeException | OutOfMemoryError fault) {
                    fault(new FixsplatException(fault.toString()));
                }
            });
            lock.notifyAll();
        }
    }

    /** Waits for a task, also if this thread is interrupted meanwhile. */
    private void finish(FutureTask<Void> task) {
        boolean wasInterrupted = false, isDone = false;
        while (!isDone)
            try {
                task.get();
                isDone = true;
            } catch (InterruptedException interrupted) {
                wasInterrupted = true;
            } catch (ExecutionException fault) {
                isDone = true;
                fault(fault.getCause() instanceof FixsplatException ? (FixsplatException) fault.getCause()
                      : new FixsplatException(fault.getCause().toString()));
            }
        if (wasInterrupted)
            Thread.currentThread().interrupt();
    }

    private void tell(Runnable call) {
        main.post(() -> {
            final boolean isLate;
            synchronized (lock) {
                isLate = isClosed;
            }
            if (!isLate)
                call.run();
        });
    }

    private void fault(FixsplatException fault) {
        tell(() -> listener.onFault(fault));
    }

    private void run() {
        while (!hasEnded) {
            final Runnable job;
            final Camera from;
            synchronized (lock) {
                while (jobs.isEmpty() && !(isDirty && canDraw()))
                    try {
                        final boolean waits = coming > 0 && canDraw();
                        lock.wait(waits ? RETRY : 0);
                        isDirty |= waits;
                    } catch (InterruptedException nobody) {
                        continue;
                    }
                job = jobs.poll();
                from = camera;
                isDirty &= job != null;
            }
            if (job != null)
                job.run();
            else
                draw(from);
        }
    }

    private boolean canDraw() {
        return !isPaused && hasSurface && scene != 0 && camera != null;
    }

    /** Draws a frame. Tells a fault once, until a frame is without. */
    private void draw(Camera from) {
        final int[] now = new int[6];
        String backEnd = null, fault = null;
        try {
            backEnd = draw(view, from.numbers(), now);
        } catch (FixsplatException thrown) {
            fault = thrown.getMessage();
            if (!fault.equals(told))
                fault(thrown);
        }
        told = fault;
        coming = now[1];
        if (backEnd == null)
            return;
        synchronized (lock) {
            state = new State(backEnd, now, state.frames + 1);
            same = now[0] == missing ? same + 1 : 0;
            isDirty |= now[5] != 0 || now[0] > 0 && same < SETTLED;
        }
        if (now[0] != missing)
            tell(() -> listener.onProgress(now[0] == 0 ? 1 : 1.0 / (1 + now[0])));
        missing = now[0];
    }

    /** Parts of the scene have arrived. Frames put them on the device, and later frames draw them. */
    private void arrived() {
        synchronized (lock) {
            same = 0;
        }
        awake();
    }

    /* ---- C: port/android/jni.c ----------------------------------------------------------------------------------- */

    private static native long open(String name, Source source, ByteBuffer bytes) throws FixsplatException;

    private static native void closeScene(long scene);

    private static native void firstCamera(long scene, int width, int height, double[] to) throws FixsplatException;

    private static native long create() throws FixsplatException;

    private static native void destroy(long view);

    private static native void take(long view, Surface surface) throws FixsplatException;

    private static native void setScene(long view, long scene);

    private static native void pace(long view, int frameNanoseconds, int budget);

    private static native String draw(long view, double[] camera, int[] to) throws FixsplatException;

    private static native boolean pick(long view, double[] camera, int x, int y, double[] to) throws FixsplatException;

    private static native void trim(long view);
}
