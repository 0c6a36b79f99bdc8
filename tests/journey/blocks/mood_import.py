from ranger_sim.builder.actuators import Eyes, Mood
