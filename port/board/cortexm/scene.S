/* A packed scene in flash, as its file is: read in place. */
    .section .scene, "a"
    .balign 64
    .global board_scene, board_scene_end
board_scene:
    .incbin SCENE
board_scene_end:
