package org.fixsplat;

import android.content.res.AssetManager;
import android.os.Handler;
import android.view.MotionEvent;
import android.view.Surface;
import android.view.SurfaceHolder;
import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.net.InetAddress;
import java.net.ServerSocket;
import java.nio.file.Files;
import java.nio.file.Path;
import java.nio.file.Paths;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.Random;
import java.util.concurrent.FutureTask;

/**
 * Tests the classes of Android on a desktop. Check COMMAND FOLDER BACKEND: draws scenes of FOLDER, and compares the
 * pictures with those of COMMAND, which draws on the processor. Prints lines with ok or FAIL.
 */
final class Check {
    private static final long PATIENCE = 60000000000L;
    private static int failed;

    private static void ok(String name, boolean is, Object... why) {
        System.out.println((is ? "ok " : "FAIL ") + name + (is ? "" : ": " + Arrays.toString(why)));
        failed += is ? 0 : 1;
    }

    /** Hears what a Fixsplat says. */
    private static final class Ear implements Fixsplat.Listener {
        final List<FixsplatException> faults = new ArrayList<>();
        int opened;
        double done;
        boolean onMain = true;

        @Override public synchronized void onOpen(Fixsplat scene) {
            opened++;
            onMain &= Thread.currentThread().getName().equals("main-looper");
            notifyAll();
        }

        @Override public synchronized void onProgress(double share) {
            done = share;
        }

        @Override public synchronized void onFault(FixsplatException fault) {
            faults.add(fault);
            onMain &= Thread.currentThread().getName().equals("main-looper");
            notifyAll();
        }

        /** Waits for an event more than `before` had; returns whether a scene was opened. */
        synchronized boolean hears(int before) throws InterruptedException {
            final long late = System.nanoTime() + PATIENCE;
            while (opened + faults.size() <= before && System.nanoTime() < late)
                wait(100);
            return opened + faults.size() > before && faults.isEmpty();
        }

        synchronized String fault() {
            return faults.isEmpty() ? "none" : faults.get(faults.size() - 1).getMessage();
        }
    }

    /** A window of the stand-in. */
    private static final class Window {
        final long handle = StandIn.newWindow();
        final Surface surface = new Surface(handle);

        Window(int width, int height) {
            StandIn.resize(handle, width, height);
        }

        long[] look() {
            final long[] now = new long[5];
            StandIn.look(handle, now);
            return now;
        }

        /** FNV-1a of the RGBA bytes, as --hash prints it. */
        String hash() {
            long hash = 0xcbf29ce484222325L;
            for (int pixel : StandIn.pixels(handle))
                for (int shift = 0; shift < 32; shift += 8)
                    hash = (hash ^ (pixel >>> shift & 255)) * 0x100000001b3L;
            return String.format("%016x", hash);
        }
    }

    private static String command, folder;
    private static final Map<String, String> KNOWN = new HashMap<>();

    /** The hash of a picture that the processor draws. */
    private static String expected(String scene, Camera c, int width, int height, int budget) throws IOException {
        final double across = Math.toRadians(c.fov) / 2;
        final double fov = height > width ? Math.toDegrees(2 * Math.atan(Math.tan(across) * height / width)) : c.fov;
        final List<String> words = new ArrayList<>(Arrays.asList(
            command, "render", folder + "/" + scene, "--backend", "cpu", "--hash", "--size", width + "x" + height,
            "--fov", "" + fov, "--eye", c.eyeX + "," + c.eyeY + "," + c.eyeZ, "--look",
            c.targetX + "," + c.targetY + "," + c.targetZ, "--up", c.upX + "," + c.upY + "," + c.upZ));
        if (budget > 0)
            words.addAll(Arrays.asList("--budget", "" + budget));
        final String key = String.join(" ", words);
        if (!KNOWN.containsKey(key)) {
            final Process process = new ProcessBuilder(words).redirectError(ProcessBuilder.Redirect.INHERIT).start();
            try (BufferedReader lines = new BufferedReader(new InputStreamReader(process.getInputStream()))) {
                KNOWN.put(key, lines.readLine());
            }
        }
        return KNOWN.get(key);
    }

    /** Waits until the window shows what the processor draws with the same camera, budget and size. */
    private static boolean shows(Fixsplat f, Window window, String scene, int width, int height) throws Exception {
        final long late = System.nanoTime() + PATIENCE;
        String hash = "", wanted = "?";
        while (!hash.equals(wanted) && System.nanoTime() < late) {
            final long[] now = window.look();
            final int budget = f.getState().budget;
            if (now[0] == width && now[1] == height && f.getState().missing == 0) {
                hash = window.hash();
                wanted = expected(scene, f.getCamera(), width, height, budget);
            }
            if (!hash.equals(wanted))
                Thread.sleep(5);
        }
        return hash.equals(wanted);
    }

    public static void main(String[] arguments) throws Exception {
        command = arguments[0];
        folder = arguments[1];
        System.load(System.getProperty("stand_in"));
        final Window window = new Window(160, 120);
        final Ear ear = new Ear();
        final Fixsplat f = new Fixsplat(ear);
        f.setPace(0, 0);
        f.setSurface(window.surface);
        f.openFile(folder + "/tree.fxs");
        ok("opens a file", ear.hears(0), ear.fault());
        ok("shows", shows(f, window, "tree.fxs", 160, 120), ear.fault(), f.getState().backEnd, f.getState().missing);
        System.out.println(f.getState().backEnd);
        f.close();
        System.exit(failed == 0 ? 0 : 1);
    }
}
