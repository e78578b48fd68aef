/* The file of a packed scene, in flash; read in place. */
    .section .scene, "a"
    .balign 64
    .global board_scene, board_scene_end
board_scene:
    .incbin SCENE
board_scene_end:
