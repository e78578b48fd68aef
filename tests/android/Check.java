package org.fixsplat;

import com.sun.net.httpserver.HttpExchange;
import com.sun.net.httpserver.HttpServer;
import android.content.res.AssetManager;
import android.view.MotionEvent;
import android.view.Surface;
import android.view.SurfaceHolder;
import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStreamReader;
import java.io.OutputStream;
import java.net.InetAddress;
import java.net.InetSocketAddress;
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
import java.util.concurrent.CountDownLatch;
import java.util.concurrent.Executors;

/**
 * Tests the classes for Android on a desktop. Check COMMAND FOLDER BACKEND EVENTS: draws scenes of FOLDER by BACKEND,
 * also during EVENTS random events. Compares the pictures with the processor's, by COMMAND. Prints lines with ok or
 * FAIL.
 */
final class Check {
    private static final long PATIENCE = 240000000000L;
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

        synchronized List<FixsplatException> all() {
            return new ArrayList<>(faults);
        }

        synchronized String fault() {
            return faults.isEmpty() ? "none" : faults.get(faults.size() - 1).getMessage();
        }
    }

    /** A window of the stand-in. */
    private static final class Window {
        final long handle = StandIn.newWindow();
        final Surface surface = new Surface(handle);

        static final List<Window> ALL = new ArrayList<>();

        Window(int width, int height) {
            StandIn.resize(handle, width, height);
            ALL.add(this);
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

    /** What the command says of a picture that the processor draws. */
    private static String said(String scene, Camera c, int width, int height, String... more) throws IOException {
        final double across = Math.toRadians(c.fov) / 2;
        final double fov = height > width ? Math.toDegrees(2 * Math.atan(Math.tan(across) * height / width)) : c.fov;
        final List<String> words = new ArrayList<>(Arrays.asList(
            command, "render", folder + "/" + scene, "--backend", "cpu", "--size", width + "x" + height,
            "--fov", "" + fov, "--eye", c.eyeX + "," + c.eyeY + "," + c.eyeZ, "--look",
            c.targetX + "," + c.targetY + "," + c.targetZ, "--up", c.upX + "," + c.upY + "," + c.upZ));
        words.addAll(Arrays.asList(more));
        final String key = String.join(" ", words);
        if (!KNOWN.containsKey(key)) {
            final Process process = new ProcessBuilder(words).redirectErrorStream(true).start();
            try (BufferedReader lines = new BufferedReader(new InputStreamReader(process.getInputStream()))) {
                KNOWN.put(key, String.join(" ", lines.lines().toArray(String[]::new)));
            }
        }
        return KNOWN.get(key);
    }

    /** The hash of a picture that the processor draws. */
    private static String expected(String scene, Camera c, int width, int height, int budget) throws IOException {
        return budget > 0 && scene.equals(TREE) ? said(scene, c, width, height, "--hash", "--budget", "" + budget)
                          : said(scene, c, width, height, "--hash");
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

    /* ---- What is shown ------------------------------------------------------------------------------------------- */

    private static final String TREE = "tree.fxs", FLAT = "flat.fxs", PLY = "knot.ply";

    /** A Fixsplat, its listener and its window. */
    private static final class App implements AutoCloseable {
        final Ear ear = new Ear();
        final Fixsplat f;
        Window window;
        String scene;

        App(int width, int height) throws Exception {
            f = new Fixsplat(ear);
            f.setPace(0, 0);
            window = new Window(width, height);
            f.setSurface(window.surface);
        }

        /** Waits for what `open` does; returns whether a scene was opened. */
        boolean opens(String name, Runnable open) throws Exception {
            final int before = ear.opened + ear.faults.size();
            open.run();
            scene = name;
            return ear.hears(before);
        }

        boolean opensFile(String name) throws Exception {
            return opens(name, () -> f.openFile(folder + "/" + name));
        }

        /** Waits until a picture is shown after those `before`. */
        void draws(long before) throws InterruptedException {
            final long late = System.nanoTime() + PATIENCE;
            while (window.look()[2] == before && System.nanoTime() < late)
                Thread.sleep(2);
        }

        boolean shown(int width, int height) throws Exception {
            return shows(f, window, scene, width, height);
        }

        void check(String name, int width, int height) throws Exception {
            final boolean is = shown(width, height);
            ok(name, is && ear.faults.isEmpty(), ear.fault(), f.getState().backEnd, f.getState().missing,
               Arrays.toString(window.look()));
        }

        /** Waits for a fault with these words; the picture stays. */
        void faults(String name, String words, Runnable call) throws Exception {
            final int before = ear.opened + ear.faults.size();
            final String shown = scene;
            call.run();
            ear.hears(before);
            ok(name, ear.fault().contains(words) && !ear.fault().contains("\n"), ear.fault());
            ear.faults.clear();
            ok(name + ": the picture stays", shown == null || shows(f, window, shown, 96, 64), ear.fault());
        }

        @Override public void close() {
            f.close();
        }
    }

    private static void opening(String backEnd) throws Exception {
        try (App app = new App(96, 64); Server server = new Server()) {
            ok("opens an .fxs in parts", app.opensFile(TREE), app.ear.fault());
            app.check("shows it", 96, 64);
            ok("by " + backEnd, app.f.getState().backEnd.equals(backEnd), app.f.getState().backEnd);
            final Camera first = app.f.getCamera();
            app.f.setCamera(first.orbit(0.7, 0.2).zoom(1.5).pan(0.1, 0.05));
            app.check("another camera", 96, 64);
            StandIn.resize(app.window.handle, 64, 96);
            app.f.setSurface(app.window.surface);
            app.check("a turned device", 64, 96);
            final long before = app.window.look()[2];
            app.f.setPace(0, 2000);
            app.draws(before);
            app.check("a budget", 64, 96);
            ok("the budget counts", app.f.getState().budget == 2000 && !expected(TREE, app.f.getCamera(), 64, 96, 2000)
               .equals(expected(TREE, app.f.getCamera(), 64, 96, 0)), app.f.getState().budget);
            app.f.setPace(0, 0);
            ok("opens an .fxs as a whole", app.opensFile(FLAT), app.ear.fault());
            app.check("shows it", 64, 96);
            ok("opens a .ply", app.opensFile(PLY), app.ear.fault());
            app.check("shows it", 64, 96);
            final AssetManager assets = new AssetManager(folder + "/assets");
            ok("opens an asset", app.opens(TREE, () -> app.f.openAsset(assets, TREE)), app.ear.fault());
            app.check("shows it", 64, 96);
            ok("opens a compressed asset", app.opens(TREE, () -> app.f.openAsset(assets, TREE + ".z")),
               app.ear.fault());
            app.check("shows it", 64, 96);
            ok("opens an address", app.opens(TREE, () -> app.f.openAddress(server.address(TREE), 5000)),
               app.ear.fault());
            app.check("shows it", 64, 96);
            ok("opens an address as a whole", app.opens(FLAT, () -> app.f.openAddress(server.address(FLAT), 5000)),
               app.ear.fault());
            app.check("shows it", 64, 96);
            ok("listens on the main thread", app.ear.onMain);
        }
    }

    private static void using() throws Exception {
        try (App app = new App(96, 64)) {
            app.opensFile(TREE);
            app.check("a picture", 96, 64);
            final CountDownLatch picked = new CountDownLatch(1);
            final Fixsplat.Pick[] answer = new Fixsplat.Pick[1];
            app.f.pick(48, 32, pick -> {
                answer[0] = pick;
                picked.countDown();
            });
            picked.await();
            final String said = said(TREE, app.f.getCamera(), 96, 64, "--pick", "48,32");
            ok("picks", answer[0] != null && said.contains("Gaussian " + answer[0].gaussian + ","), said,
               answer[0] == null ? -1 : answer[0].gaussian);
            final long[] before = app.window.look();
            Thread.sleep(200);
            ok("draws nothing without a change", app.window.look()[2] == before[2], before[2]);
            app.f.pause();
            app.f.setCamera(app.f.getCamera().zoom(1.1));
            Thread.sleep(100);
            ok("draws nothing in a pause", app.window.look()[2] == before[2]);
            app.f.resume();
            app.check("after the pause", 96, 64);
            app.f.trim();
            app.f.redraw();
            app.draws(before[2] + 1);
            app.check("with less memory", 96, 64);
            app.f.setSurface(null);
            app.f.trim();
            app.f.setSurface(app.window.surface);
            app.check("with less memory, after the surface was gone", 96, 64);
            app.f.setPace(1000, 1000000);
            final long late = System.nanoTime() + PATIENCE;
            while (app.f.getState().width == 96 && System.nanoTime() < late)
                app.f.setCamera(app.f.getCamera().orbit(0.01, 0));
            ok("the clock makes smaller pictures", app.f.getState().width < 96 && app.ear.faults.isEmpty(),
               app.ear.fault());
            ok("for the whole window", app.window.look()[0] == 96);
            app.f.setPace(0, 0);
            app.check("and full ones without a rate", 96, 64);
        }
    }

    private static void touching() throws Exception {
        final FixsplatView view = new FixsplatView(null);
        final Window window = new Window(96, 64);
        final Ear ear = new Ear();
        final SurfaceHolder holder = new SurfaceHolder() {
            @Override public Surface getSurface() {
                return window.surface;
            }

            @Override public void addCallback(SurfaceHolder.Callback callback) {
            }
        };
        final Fixsplat f = view.start(ear);
        f.setPace(0, 0);
        view.callback.surfaceCreated(holder);
        view.callback.surfaceChanged(holder, 1, 96, 64);
        f.openFile(folder + "/" + FLAT);
        ear.hears(0);
        final Camera first = f.getCamera();
        view.onTouchEvent(new MotionEvent(MotionEvent.ACTION_DOWN, 20, 20));
        view.onTouchEvent(new MotionEvent(MotionEvent.ACTION_MOVE, 60, 40));
        final Camera turned = f.getCamera();
        view.onTouchEvent(new MotionEvent(MotionEvent.ACTION_MOVE, 20, 20, 80, 20));
        view.onTouchEvent(new MotionEvent(MotionEvent.ACTION_MOVE, 10, 30, 100, 30));
        final Camera moved = f.getCamera();
        view.onTouchEvent(new MotionEvent(MotionEvent.ACTION_UP, 10, 30));
        view.onTouchEvent(new MotionEvent(MotionEvent.ACTION_MOVE, 90, 90));
        ok("one finger turns", turned.targetX == first.targetX && distance(turned) / distance(first) > 0.999999
           && distance(turned) / distance(first) < 1.000001 && turned.eyeX != first.eyeX);
        ok("two fingers move and bring nearer", moved.targetX != turned.targetX
           && Math.abs(distance(moved) * 1.5 / distance(turned) - 1) < 1e-9, distance(moved));
        ok("a finger that was up turns nothing", f.getCamera() == moved);
        ok("shows it", shows(f, window, FLAT, 96, 64), ear.fault());
        view.onTrimMemory(80);
        view.callback.surfaceDestroyed(holder);
        ok("the window is free", window.look()[3] == 0 && window.look()[4] == 0, Arrays.toString(window.look()));
        view.close();
        view.close();
        view.callback.surfaceChanged(holder, 1, 96, 64);
        final Ear other = new Ear();
        final Fixsplat late = view.start(other);
        late.setPace(0, 0);
        late.openFile(folder + "/" + FLAT);
        ok("a view that starts late", other.hears(0) && shows(late, window, FLAT, 96, 64), other.fault());
        view.close();
        view.callback.surfaceDestroyed(holder);
        view.onTouchEvent(new MotionEvent(MotionEvent.ACTION_DOWN, 20, 20));
    }

    private static double distance(Camera c) {
        return Math.sqrt(Math.pow(c.eyeX - c.targetX, 2) + Math.pow(c.eyeY - c.targetY, 2)
                         + Math.pow(c.eyeZ - c.targetZ, 2));
    }

    /* ---- Faults -------------------------------------------------------------------------------------------------- */

    private static void refusing() throws Exception {
        final Path cut = Paths.get(folder, "cut.fxs");
        final byte[] whole = Files.readAllBytes(Paths.get(folder, TREE));
        Files.write(cut, Arrays.copyOf(whole, whole.length / 2));
        final Path notes = Paths.get(folder, "notes.txt");
        Files.write(notes, "no scene".getBytes());
        Files.write(Paths.get(folder, "assets", "cut.fxs"), Arrays.copyOf(whole, whole.length / 3));
        try (App app = new App(96, 64); Server server = new Server(); ServerSocket silent = silent()) {
            final AssetManager assets = new AssetManager(folder + "/assets");
            final String hangs = "http://127.0.0.1:" + silent.getLocalPort() + "/";
            app.faults("a file that is not there", "nowhere.fxs", () -> app.f.openFile(folder + "/nowhere.fxs"));
            app.opensFile(TREE);
            app.check("a picture", 96, 64);
            app.faults("a cut file", "cut.fxs", () -> app.f.openFile(cut.toString()));
            app.faults("a cut asset", "cut.fxs", () -> app.f.openAsset(assets, "cut.fxs"));
            app.faults("an asset that is not there", "nowhere", () -> app.f.openAsset(assets, "nowhere"));
            app.faults("a file without a scene", "notes", () -> app.f.openFile(notes.toString()));
            app.faults("no address", "unknown", () -> app.f.openAddress("unknown:", 500));
            app.faults("an address that is not there", "404", () -> app.f.openAddress(server.address("no"), 5000));
            app.faults("a server without parts", "parts", () -> app.f.openAddress(server.address("all"), 5000));
            app.faults("an address that hangs", "no answer in 300 ms", () -> app.f.openAddress(hangs, 300));
            app.faults("an address that sends a byte now and then", "no answer in 300 ms",
                       () -> app.f.openAddress(server.address("drops"), 300));
            app.f.pause();
            ok("opens an address", app.opens(TREE, () -> app.f.openAddress(server.address(TREE), 5000)));
            server.isBroken = true;
            app.f.resume();
            app.ear.hears(app.ear.opened);
            ok("a server that breaks", app.ear.fault().contains("answered with 500"), app.ear.fault());
            ok("is told once", app.ear.faults.size() == 1, app.ear.faults.size());
            app.ear.faults.clear();
            server.isBroken = false;
            app.check("and works again", 96, 64);
            final long begin = System.nanoTime();
            app.f.openAddress(hangs, 100000);
            Thread.sleep(100);
            ok("another scene in place of one that hangs", app.opensFile(FLAT) && System.nanoTime() - begin < 9e9);
            app.check("shows it", 96, 64);
            app.f.openAddress(hangs, 100000);
            app.f.cancel();
            app.f.openAddress(hangs, 100000);
            Thread.sleep(100);
        }
        ok("closes while an address hangs", true);
    }

    private static void losing() throws Exception {
        try (App app = new App(96, 64)) {
            app.opensFile(TREE);
            app.check("a picture", 96, 64);
            for (int which : new int[] {StandIn.OUT_OF_DATE, StandIn.SURFACE_LOST, StandIn.DEVICE_LOST}) {
                StandIn.fail(which, 1);
                app.f.setCamera(app.f.getCamera().orbit(0.1, 0));
                app.f.setSurface(app.window.surface);
                app.check("after fault " + which, 96, 64);
                StandIn.fail(which, 0);
            }
            StandIn.fail(StandIn.DEVICE_LOST, 1000);
            app.f.setCamera(app.f.getCamera().zoom(1.2));
            ok("a device that is lost again and again", !app.ear.hears(app.ear.opened), app.ear.fault());
            StandIn.fail(StandIn.DEVICE_LOST, 0);
            app.ear.faults.clear();
            app.f.redraw();
            app.check("and is there again", 96, 64);
            StandIn.resize(app.window.handle, 0, 0);
            app.f.setSurface(app.window.surface);
            app.f.setCamera(app.f.getCamera().zoom(1.1));
            ok("a surface of 0x0", app.ear.faults.isEmpty() && app.window.look()[3] == 0, app.ear.fault());
            StandIn.resize(app.window.handle, 96, 64);
            app.f.setSurface(app.window.surface);
            app.check("that gets a size", 96, 64);
            app.f.setSurface(new Surface(0));
            app.ear.hears(app.ear.opened);
            ok("a surface that was released", app.ear.fault().contains("released"), app.ear.fault());
            app.ear.faults.clear();
            app.f.setSurface(app.window.surface);
            app.check("and another one", 96, 64);
        }
        StandIn.fail(StandIn.NO_VULKAN, 1 << 30);
        StandIn.fail(StandIn.NO_EGL, 1 << 30);
        try (App app = new App(96, 64)) {
            app.opensFile(TREE);
            app.ear.hears(app.ear.opened);
            ok("no device", app.ear.fault().contains("OpenGL ES: no display"), app.ear.fault());
        }
    }

    private static void refusesAfterClose() throws Exception {
        final App app = new App(96, 64);
        app.opensFile(FLAT);
        app.f.close();
        app.f.close();
        final Runnable[] calls = {
            () -> app.f.openFile("x"), () -> app.f.openAsset(null, "x"), () -> app.f.openAddress("http://x", 1),
            () -> app.f.cancel(), () -> app.f.setSurface(null), () -> app.f.pause(), () -> app.f.resume(),
            () -> app.f.getCamera(), () -> app.f.setCamera(new Camera(0, 0, 0, 0, 0, 1, 0, -1, 0, 50)),
            () -> app.f.redraw(), () -> app.f.setPace(60, 0), () -> app.f.trim(), () -> app.f.pick(0, 0, null),
            () -> app.f.getState()};
        int refused = 0;
        for (Runnable call : calls)
            try {
                call.run();
            } catch (IllegalStateException closed) {
                refused++;
            }
        ok("each call after close throws", refused == calls.length, refused);
    }

    /* ---- Servers ------------------------------------------------------------------------------------------------- */

    private static ServerSocket silent() throws IOException {
        return new ServerSocket(0, 50, InetAddress.getLoopbackAddress());
    }

    /** Sends parts of the files of the folder; "all" as a whole, "drops" a byte at a time, others not. */
    private static final class Server implements AutoCloseable {
        private final HttpServer http =
            HttpServer.create(new InetSocketAddress(InetAddress.getLoopbackAddress(), 0), 0);

        volatile boolean isBroken;

        Server() throws IOException {
            http.setExecutor(Executors.newCachedThreadPool(code -> {
                final Thread thread = new Thread(code);
                thread.setDaemon(true);
                return thread;
            }));
            http.createContext("/", this::answer);
            http.start();
        }

        String address(String name) {
            return "http://127.0.0.1:" + http.getAddress().getPort() + "/" + name;
        }

        private void answer(HttpExchange call) throws IOException {
            final String name = call.getRequestURI().getPath().substring(1);
            final boolean isSpecial = name.equals("all") || name.equals("drops");
            final Path path = Paths.get(folder, isSpecial ? TREE : name);
            final String[] ends = call.getRequestHeaders().getFirst("Range").substring(6).split("-");
            if (isBroken || !Files.exists(path)) {
                call.sendResponseHeaders(isBroken ? 500 : 404, -1);
                return;
            }
            final byte[] all = Files.readAllBytes(path);
            final int first = Integer.parseInt(ends[0]), last = Math.min(Integer.parseInt(ends[1]), all.length - 1);
            call.getResponseHeaders().set("Content-Range", "bytes " + first + "-" + last + "/" + all.length);
            call.sendResponseHeaders(name.equals("all") ? 200 : 206, name.equals("drops") ? 0 : last + 1 - first);
            try (OutputStream to = call.getResponseBody()) {
                for (int i = first; name.equals("drops") && i <= last; i++) {
                    to.write(all[i]);
                    to.flush();
                    Thread.sleep(50);
                }
                if (!name.equals("drops"))
                    to.write(all, first, last + 1 - first);
            } catch (InterruptedException nobody) {
                return;
            }
        }

        @Override public void close() {
            http.stop(0);
        }
    }

    /* ---- A life -------------------------------------------------------------------------------------------------- */

    private static final int[][] SIZES = {{96, 64}, {64, 96}, {64, 64}, {33, 70}};

    private static void live(int events, long seed) throws Exception {
        final Random random = new Random(seed);
        App app = null;
        Camera first = null;
        int[] size = SIZES[0];
        boolean has = false, isPaused = false;
        int checked = 0, reopened = 0;
        String fault = null;
        for (int i = 0; i < events && fault == null; i++) {
            final boolean sleeps = app != null && (!has || isPaused) && random.nextInt(3) > 0;
            final int event = app == null ? 0 : sleeps ? has ? 18 : 12 : random.nextInt(60);
            final long shown = app == null ? 0 : app.window.look()[2];
            if (event == 0) {
                if (app != null)
                    app.close();
                app = new App(size[0], size[1]);
                app.opensFile(TREE);
                first = app.f.getCamera();
                has = true;
                isPaused = false;
                reopened++;
            } else if (event < 8) {
                size = SIZES[random.nextInt(SIZES.length)];
                StandIn.resize(app.window.handle, size[0], size[1]);
                if (has)
                    app.f.setSurface(app.window.surface);
            } else if (event < 12) {
                app.f.setSurface(null);
                has = false;
                if (app.window.look()[3] != 0 || app.window.look()[4] != 0)
                    fault = "a window that is gone is in use";
            } else if (event < 18) {
                app.window = has && random.nextBoolean() ? app.window : new Window(size[0], size[1]);
                app.f.setSurface(app.window.surface);
                has = true;
            } else if (event < 22) {
                isPaused = !isPaused;
                if (isPaused)
                    app.f.pause();
                else
                    app.f.resume();
            } else if (event < 28 || event >= 40) {
                app.f.setCamera(first.orbit(random.nextInt(4) * Math.PI / 2, 0));
            } else if (event < 30) {
                app.opensFile(random.nextBoolean() ? TREE : FLAT);
            } else if (event < 32) {
                app.f.trim();
            } else if (event < 33) {
                app.f.openFile(folder + "/nowhere");
            } else if (event < 35) {
                app.f.setPace(0, random.nextBoolean() ? 2000 : 0);
            } else {
                StandIn.fail(event < 37 ? StandIn.OUT_OF_DATE
                             : event < 38 ? StandIn.SURFACE_LOST : StandIn.DEVICE_LOST, 1);
                app.f.redraw();
                if (has && !isPaused)
                    app.draws(shown);
            }
            if (has && !isPaused && random.nextBoolean()) {
                checked++;
                if (!app.shown(size[0], size[1]))
                    fault = "a wrong picture";
            }
            for (FixsplatException said : app.ear.all())
                if (!said.getMessage().contains("nowhere"))
                    fault = said.getMessage();
            if (fault != null)
                fault = "event " + i + " (" + event + "): " + fault + " " + Arrays.toString(app.window.look())
                        + Arrays.toString(size) + app.f.getState().missing + " of " + app.f.getState().budget;
        }
        if (app != null)
            app.close();
        ok(events + " events, " + checked + " pictures compared, opened " + reopened + " times", fault == null, fault);
    }

    /** What is left behind by a life: blocks, references, windows. */
    private static void leaves(String name) throws Exception {
        final long blocks = StandIn.blocks();
        final int references = StandIn.globalReferences();
        ok(name + ": no memory is left", blocks == blocksBefore, blocks, blocksBefore);
        ok(name + ": no references are left", references == referencesBefore, references, referencesBefore);
        for (Window window : Window.ALL)
            if (window.look()[3] != 0 || window.look()[4] != 0)
                ok(name + ": a window is left", false, Arrays.toString(window.look()));
    }

    private static long blocksBefore;
    private static int referencesBefore;

    /** Draws and picks once. Only CUDA's runtime, which Android has not, may keep memory from its first use on. */
    private static void useOnce() throws Exception {
        try (App app = new App(96, 64)) {
            final CountDownLatch picked = new CountDownLatch(1);
            app.opensFile(FLAT);
            app.check("draws", 96, 64);
            app.f.pick(48, 32, pick -> picked.countDown());
            picked.await();
        }
        blocksBefore = StandIn.blocks();
        ok("the first use leaves no memory", blocksBefore == 0 || Boolean.getBoolean("cuda"), blocksBefore);
    }

    public static void main(String[] arguments) throws Exception {
        final String backEnd = arguments[2];
        command = arguments[0];
        folder = arguments[1];
        System.load(System.getProperty("stand_in"));
        StandIn.fail(StandIn.NO_VULKAN, backEnd.equals("vulkan") ? 0 : 1 << 30);
        StandIn.fail(StandIn.NO_COMPUTE, backEnd.equals("gles") ? 1 << 30 : 0);
        new Fixsplat(null).close();
        referencesBefore = StandIn.globalReferences();
        useOnce();
        opening(backEnd);
        using();
        touching();
        leaves("use");
        live(Integer.parseInt(arguments[3]), 1);
        leaves("a life");
        refusing();
        refusesAfterClose();
        leaves("faults");
        losing();
        leaves("losses");
        System.exit(failed == 0 ? 0 : 1);
    }
}
