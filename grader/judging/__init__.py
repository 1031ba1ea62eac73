"""Run the exercises of one submission and give each grade cell its verdict."""
